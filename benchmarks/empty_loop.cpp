#include "benchmarks/empty_loop.h"

#include <cerrno>
#include <chrono>
#include <ctime>
#include <thread>

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#endif

namespace lobe::bench {
namespace {

constexpr std::int64_t second = 1'000'000'000, period = 1'000'000;  // [ns]

std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t(time.tv_sec) * second + time.tv_nsec;
}

void sleep_until(std::int64_t due) {
#if defined(__linux__)
  const timespec time{static_cast<time_t>(due / second), static_cast<long>(due % second)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
#else
  std::this_thread::sleep_for(std::chrono::nanoseconds(due - now()));
#endif
}

bool become_real_time([[maybe_unused]] int priority) {
#if defined(__linux__)
  sched_param parameters{};
  parameters.sched_priority = priority;
  return priority > 0 && pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
#else
  return false;
#endif
}

void run(double seconds, LoopTimes& times) {
  std::int64_t due = now() + period;
  const std::int64_t end = due + std::int64_t(1e9 * seconds);
  while (due < end) {
    sleep_until(due);
    const std::int64_t begun = now();
    times.lateness.add(1e-9 * double(begun - due));
    times.compute.add(1e-9 * double(now() - begun));
    for (due += period; due <= begun; due += period) times.missed.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace

bool time_empty_loop(int priority, double seconds, LoopTimes& times) {
  bool is_real_time = false;
  std::thread([&] {
    is_real_time = become_real_time(priority);
    run(seconds, times);
  }).join();
  return is_real_time;
}

}  // namespace lobe::bench
