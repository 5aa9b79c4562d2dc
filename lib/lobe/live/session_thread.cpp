// The thread of a session. It follows the clock, and between frames does the work for which other threads
// wait.
#include <algorithm>

#include "lobe/live/session.h"

namespace lobe {

using Clock = Pace::Clock;

template <class Real>
void Session<Real>::start() {
  if (is_started()) return;
  stops_ = false;
  is_driven_ = true;
  pace_.start(Clock::now());
  thread_ = std::thread([this] { run(); });
}

// Another thread may still wait for work that this thread has not seen.
template <class Real>
void Session<Real>::stop() {
  if (!is_started()) return;
  stops_ = true;
  queue_.wake();
  thread_.join();
  while (!asking_.try_lock()) do_work();
  is_driven_ = false;
  asking_.unlock();
}

template <class Real>
void Session<Real>::run() {
  while (!stops_) try {
      run_frame();
    } catch (const std::exception& error) {
      fail(error.what());
    } catch (...) {
      fail("an exception of an unknown type");
    }
}

template <class Real>
void Session<Real>::run_frame() {
  const std::uint32_t signal = queue_.signal();
  do_work();
  const Clock::time_point began = Clock::now();
  if (!step_frame()) {
    if (!stops_ && !work_.load()) queue_.wait(signal);
    return;
  }
  const Clock::time_point now = Clock::now();
  const Clock::time_point due = pace_.frame_done(now, frame_, speed_, now - began);
  if (options_.paced) wait_until(due);
}

// What was done to the world in that frame is in no recording. So nothing more is done to it until it is put
// back. A status that cannot be made now, for want of memory for example, is made a moment later.
template <class Real>
void Session<Real>::fail(const std::string& why) try {
  has_failed_ = stands_still_ = was_changed_ = true;
  set_running(false);
  steps_once_ = false;
  hands_.forget();
  say("failed", why + ": go back, or restart");
  publish({});
} catch (const std::exception&) {
  was_told_ = true;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

// In slow motion, work that is asked for between two frames does not wait for the next one.
template <class Real>
void Session<Real>::wait_until(Clock::time_point due) {
  constexpr std::chrono::milliseconds slice(5);
  std::uint32_t signal = queue_.signal();
  const double speed = speed_;
  for (auto now = Clock::now(); now < due; now = Clock::now()) {
    std::this_thread::sleep_until(std::min(due, now + slice));
    if (due - now <= slice || signal == queue_.signal()) continue;
    signal = queue_.signal();
    do_work();
    take_commands();
    if (stops_ || !is_running_ || speed_ != speed) return;
    if (was_changed_) publish({});
    if (was_told_) publish_status();
  }
}

template <class Real>
void Session<Real>::do_work() {
  const std::function<void()>* work = work_.load(std::memory_order_acquire);
  if (!work) return;
  try {
    (*work)();
  } catch (...) {
    work_failed_ = std::current_exception();
  }
  work_.store(nullptr, std::memory_order_release);
  work_.notify_all();
}

template <class Real>
void Session<Real>::between_frames(const std::function<void()>& work) {
  const std::lock_guard lock(asking_);
  if (!is_driven_) return work();
  work_.store(&work, std::memory_order_release);
  queue_.wake();
  work_.wait(&work, std::memory_order_acquire);
  if (work_failed_) std::rethrow_exception(std::exchange(work_failed_, nullptr));
}

}  // namespace lobe
