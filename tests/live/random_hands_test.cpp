// Whatever hands do, whenever they do it and whoever looks on: a replay of the record gives the same bits.
#include "benchmarks/random_hands.h"

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "live/hands_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

using bench::RandomHands;

std::chrono::microseconds at_most(RandomHands& hands, int microseconds) {
  return std::chrono::microseconds(hands.dice(microseconds));
}

// Sends for as long as it is told, at random times, and leaves in the middle of something every now and then.
void send(Session<float>& session, unsigned seed, bench::RandomHandsOptions options,
          const std::atomic<bool>& stops) {
  RandomHands hands(seed, std::move(options));
  std::optional<Controller> controller;
  while (!stops) {
    if (!controller || hands.dice(200) == 0) controller.emplace(session.connect("somebody"));
    controller->send(hands.next());
    if (hands.dice(20) == 0) controller->send({.kind = Kind::run, .on = true});
    std::this_thread::sleep_for(at_most(hands, 400));
  }
}

// Looks at pictures, holding some of them for long.
void look(const Session<float>& session, unsigned seed, const std::atomic<bool>& stops,
          std::atomic<long>& faults) {
  RandomHands hands(seed, {});
  std::array<TripleBuffer<Snapshot<float>>::View, 3> held;
  while (!stops) {
    auto& view = held[std::size_t(hands.dice(3))];
    const auto status = session.status();
    view = session.pictures().latest();
    faults += !view->u.allFinite() || view->frame < status->picture;
    faults += view->surface.x.cols() != view->surface.mesh->vertex_count();
    std::this_thread::sleep_for(at_most(hands, 5000));
  }
}

struct Play {
  Recording recording;
  std::uint64_t last = 0;  // digest
  Index alive = 0;
  long faults = 0;
};

Play play(const Setup& setup, int threads, bool edits) {
  SessionOptions options;
  options.threads = threads;
  options.paced = false;
  options.back_every = 0.1;
  Session<float> session(setup, options);
  bench::RandomHandsOptions random{.low = Vec3d::Zero(), .high = Vec3d::Constant(0.05), .removable = {}};
  if (edits) random.removable = {100, 200, 300, 301, 302, 400, 401};
  std::atomic<bool> stops = false;
  std::atomic<long> faults = 0;
  std::vector<std::thread> others;
  for (unsigned i = 0; i < 2; ++i)
    others.emplace_back([&, i] { send(session, 10 * unsigned(threads) + i, random, stops); });
  for (unsigned i = 0; i < 2; ++i) others.emplace_back([&, i] { look(session, i, stops, faults); });
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  stops = true;
  for (std::thread& thread : others) thread.join();
  session.stop();
  return {session.recording(), digest(session.world()), session.world().elements().topology.alive_count(),
          faults};
}

template <class Entry>
long count(const Recording& recording) {
  long entries = 0;
  for (const RecordedCommand& recorded : recording.commands) {
    if constexpr (std::is_same_v<Entry, GoBack>)
      entries += std::holds_alternative<GoBack>(recorded.command);
    else if (const auto* command = std::get_if<Command>(&recorded.command))
      entries += std::holds_alternative<Entry>(*command);
  }
  return entries;
}

}  // namespace

TEST_CASE("what random hands of several threads did is replayed bit for bit, on one thread and on two") {
  const Setup setup = block();
  for (int threads : {1, 2}) {
    const Play played = play(setup, threads, true);
    CHECK(played.faults == 0);
    CHECK(count<Advance>(played.recording) > 100);
    CHECK(count<TakeHold>(played.recording) > 3);
    CHECK(count<Lead>(played.recording) > 30);
    CHECK(count<LetGo>(played.recording) > 3);
    CHECK(count<SwitchCautery>(played.recording) > 0);
    CHECK(count<GoBack>(played.recording) > 0);
    for (int again : {1, 2}) {
      World<float> world(setup, again);
      const Replayed replayed = replay(played.recording, world);
      CHECK(replayed.commands == played.recording.commands.size());
      CHECK(replayed.same);
      CHECK(digest(world) == played.last);
      CHECK(world.elements().topology.alive_count() == played.alive);
    }
  }
}
