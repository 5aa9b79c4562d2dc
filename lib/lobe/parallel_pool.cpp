// Parallel by threads of lobe's own, where oneTBB is not to be had. Work is divided into one part per thread.
// Whoever is free takes the next part, so that the caller waits for no thread that the system has not yet
// woken.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "lobe/parallel.h"

namespace lobe {
namespace {

// Set in the threads that do a part of some work. What they call is not divided again.
thread_local bool does_a_part = false;

// Waits until the value is no longer `old`. Steps follow each other within microseconds: so it looks for some
// of them before it sleeps.
template <class Value>
void wait_while(const std::atomic<Value>& value, Value old) {
  for (int look = 0; look < 1000; ++look)
    if (value.load(std::memory_order_acquire) != old) return;
  while (value.load(std::memory_order_acquire) == old) value.wait(old, std::memory_order_acquire);
}

// Which part of which run is to be taken next. A thread that wakes late finds another run's number in place
// of the one that it has read, and takes nothing of the old one.
struct Ticket {
  std::uint64_t run : 32, parts : 16, next : 16;
};
using TicketBits = std::uint64_t;

}  // namespace

struct Parallel::Arena {
  struct Work {
    Function function = nullptr;
    void* body = nullptr;
    Index count = 0;
    int parts = 0;
  };

  explicit Arena(int threads) {
    try {
      for (int t = 1; t < threads; ++t) workers.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {  // no more threads are to be had: fewer do the work
    }
  }
  ~Arena() {
    ends = true;
    announce(0);
    for (std::thread& worker : workers) worker.join();
  }

  void run(const Work& asked) {
    const std::lock_guard one_caller(calls);
    work = asked;
    done.store(0, std::memory_order_relaxed);
    announce(asked.parts);
    while (take_part()) {
    }
    for (int parts = done.load(std::memory_order_acquire); parts < asked.parts;
         parts = done.load(std::memory_order_acquire))
      wait_while(done, parts);
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  }

 private:
  void announce(int parts) {
    const auto last = std::bit_cast<Ticket>(ticket.load(std::memory_order_relaxed));
    const Ticket first{.run = last.run + 1u, .parts = std::uint64_t(parts), .next = 0};
    ticket.store(std::bit_cast<TicketBits>(first), std::memory_order_release);
    ticket.notify_all();
  }

  void serve() {
    while (!ends) {
      const TicketBits seen = ticket.load(std::memory_order_acquire);
      if (!take_part() && !ends) wait_while(ticket, seen);
    }
  }

  // Does the next part of the present run. False: all are taken.
  bool take_part() {
    TicketBits seen = ticket.load(std::memory_order_acquire);
    Ticket taken, after;
    do {
      taken = after = std::bit_cast<Ticket>(seen);
      if (taken.next >= taken.parts) return false;
      ++after.next;
    } while (!ticket.compare_exchange_weak(seen, std::bit_cast<TicketBits>(after), std::memory_order_acq_rel,
                                           std::memory_order_acquire));
    do_part(static_cast<int>(taken.next));
    if (done.fetch_add(1, std::memory_order_acq_rel) + 1 == static_cast<int>(taken.parts)) done.notify_one();
    return true;
  }

  void do_part(int part) {
    const auto start_of = [&](std::int64_t p) { return static_cast<Index>(work.count * p / work.parts); };
    does_a_part = true;
    try {
      work.function(work.body, start_of(part), start_of(part + 1));
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
    }
    does_a_part = false;
  }

  std::mutex calls, failing;
  Work work;
  std::exception_ptr failure;         // the first one of a run
  std::atomic<TicketBits> ticket{0};  // a Ticket
  std::atomic<int> done{0};           // parts of the run
  std::atomic<bool> ends{false};
  std::vector<std::thread> workers;
};

Parallel::Parallel(int threads) : threads_(std::max(1, threads)) {
  if (threads_ > 1) arena_ = std::make_unique<Arena>(threads_);
}
Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;
Parallel& Parallel::operator=(Parallel&&) noexcept = default;

void Parallel::run(Index count, Index grain, Function function, void* body) {
  if (does_a_part) return function(body, 0, count);
  const std::int64_t ranges = (std::int64_t(count) + grain - 1) / grain;
  arena_->run({function, body, count, static_cast<int>(std::min<std::int64_t>(threads_, ranges))});
}

}  // namespace lobe
