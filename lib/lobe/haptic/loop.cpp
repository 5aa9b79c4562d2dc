#include "lobe/haptic/loop.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#endif

#include "lobe/text.h"

namespace lobe {
namespace {

using Nanoseconds = std::int64_t;

Nanoseconds now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return Nanoseconds(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

void sleep_until(Nanoseconds due) {
#if defined(__linux__)
  const timespec time{static_cast<time_t>(due / 1'000'000'000), static_cast<long>(due % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
#else
  std::this_thread::sleep_for(std::chrono::nanoseconds(due - now()));
#endif
}

}  // namespace

HapticLoop::HapticLoop(HapticDevice& device, HapticLink& link, const LoopOptions& options)
    : device_(device), servo_(link, device.limits(), options.servo), options_(options) {}

void HapticLoop::start() {
  if (thread_.joinable()) return;
  stops_ = is_ready_ = false;
  warnings_.clear();
  thread_ = std::thread([this] { run(); });
  is_ready_.wait(false);
}

void HapticLoop::stop() {
  if (!thread_.joinable()) return;
  stops_ = true;
  thread_.join();
  device_.write(Vec3d::Zero(), Vec3d::Zero());
}

void HapticLoop::forget_times() {
  times_.lateness.clear();
  times_.compute.clear();
  times_.missed = 0;
}

void HapticLoop::become_real_time() {
  is_real_time_ = false;
#if defined(__linux__)
  if (options_.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options_.priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    is_real_time_ = error == 0;
    if (error != 0)
      warnings_.push_back(
          "the haptic loop is an ordinary thread (SCHED_FIFO: " + std::string(std::strerror(error)) +
          "): while other programs run, some ticks in a thousand come milliseconds late, and "
          "stiff contacts may vibrate; allow rtprio " +
          std::to_string(options_.priority) + " in /etc/security/limits.conf");
  }
  if (options_.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    warnings_.push_back(std::string("the memory of the haptic loop is not locked (mlockall: ") +
                        std::strerror(errno) +
                        "): where memory is short a tick may wait for the disk; allow memlock unlimited in "
                        "/etc/security/limits.conf");
#else
  warnings_.push_back("the haptic loop is an ordinary thread: this system has no SCHED_FIFO");
#endif
}

void HapticLoop::tick(double dt) {
  if (const Vec3d* tool = servo_.new_tool()) device_.begin_at(*tool);
  DeviceState device;
  const bool is_there = device_.read(device);
  const HapticState& state = servo_.tick_with_model(is_there ? &device : nullptr, dt);
  device_.write(state.force, state.torque);
}

void HapticLoop::run() {
  become_real_time();
  is_ready_ = true;
  is_ready_.notify_all();
  const Nanoseconds period = static_cast<Nanoseconds>(1e9 * options_.servo.tick);
  Nanoseconds due = now() + period, before = now();
  while (!stops_.load(std::memory_order_relaxed)) {
    sleep_until(due);
    const Nanoseconds begun = now();
    tick(1e-9 * double(std::max<Nanoseconds>(begun - before, 1000)));
    const Nanoseconds done = now();
    times_.lateness.add(1e-9 * double(begun - due));
    times_.compute.add(1e-9 * double(done - begun));
    before = begun;
    due += period;
    while (due <= done) {  // what is past is left out
      due += period;
      times_.missed.fetch_add(1, std::memory_order_relaxed);
    }
  }
}

}  // namespace lobe
