// Senders and the one who takes, all as fast as they can: meant for the thread sanitizer, too.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "lobe/live/hand_queue.h"

using namespace lobe;

namespace {

using Kind = HandCommand::Kind;

constexpr int senders = 3;
constexpr std::uint64_t commands = 30000;  // of each sender

// Numbered commands, of which two in three are poses; all of a command is made from its number.
HandCommand numbered(std::uint64_t number) {
  const double x = double(number);
  HandCommand command{.kind = number % 3 == 0 ? Kind::turn_on : Kind::lead, .hand = 1, .sequence = number};
  command.position = {x, 2 * x, 3 * x};
  command.value = -x;
  return command;
}

bool is_whole(const HandCommand& command) {
  const HandCommand right = numbered(command.sequence);
  return command.kind == right.kind && command.position == right.position && command.value == right.value;
}

struct Taken {
  std::uint64_t last = 0, burns = 0;
  long faults = 0;
};

}  // namespace

TEST_CASE(
    "of three senders every command arrives whole and in order, but for poses that newer ones replaced") {
  HandQueue queue(64);
  std::vector<std::thread> threads;
  std::array<int, senders> who{};
  for (int s = 0; s < senders; ++s) {
    who[std::size_t(s)] = queue.connect("sender");
    threads.emplace_back([&queue, controller = who[std::size_t(s)]] {
      for (std::uint64_t number = 1; number <= commands; ++number)
        while (!queue.send(controller, numbered(number))) std::this_thread::yield();
      queue.disconnect(controller);
    });
  }
  std::array<Taken, senders> seen;
  std::size_t ended = 0;
  std::mt19937 random(1);
  while (ended < senders) {
    const std::uint32_t signal = queue.signal();  // before what it tells of is looked at
    const std::vector<int> gone = queue.gone();
    bool any = false;
    while (const auto sent = queue.take()) {
      any = true;
      Taken& taken = seen[std::size_t(sent->controller)];
      taken.faults += !is_whole(sent->command) || sent->command.sequence <= taken.last;
      taken.last = sent->command.sequence;
      taken.burns += sent->command.kind == Kind::turn_on;
      if (random() % 500 == 0) std::this_thread::sleep_for(std::chrono::microseconds(random() % 200));
    }
    for (int controller : gone) {
      CHECK(seen[std::size_t(controller)].last == commands);
      queue.forget(controller);
      ++ended;
    }
    if (!any && gone.empty()) queue.wait(signal);
  }
  for (std::thread& thread : threads) thread.join();
  for (const Taken& taken : seen) {
    CHECK(taken.faults == 0);
    CHECK(taken.burns == commands / 3);
  }
}
