// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "lobe/text.h"
#include "lobe_mesh/errors.h"

namespace lobe::meshing {

// Raises a flag when the time is over, or when its owner gives a reason, unless it is destroyed before.
class Alarm {
 public:
  explicit Alarm(double seconds)
      : limit_(seconds),
        end_(Clock::now() +
             std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))),
        thread_([this] { wait(); }) {}
  ~Alarm() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    condition_.notify_all();
    thread_.join();
  }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  std::atomic<bool>* flag() { return &ringing_; }
  void ring(const std::string& reason) {
    reason_ = reason;
    ringing_ = true;
  }
  bool rings() const { return ringing_; }
  double seconds_left() const { return std::chrono::duration<double>(end_ - Clock::now()).count(); }
  void check() const {
    if (!ringing_ && seconds_left() > 0) return;
    if (!reason_.empty())
      throw MeshingFailure(
          "the mesher cgal " + reason_ +
          ": use another --edge, or for surfaces --feature-angle 180, --mesher tetgen or --repair wrap");
    throw MeshingFailure("the mesher cgal did not finish within the time limit of " + rounded(limit_) +
                         " s: choose a longer edge or --time-limit");
  }

 private:
  using Clock = std::chrono::steady_clock;

  void wait() {
    std::unique_lock lock(mutex_);
    if (!condition_.wait_until(lock, end_, [this] { return done_; })) ringing_ = true;
  }

  double limit_;
  std::string reason_;
  Clock::time_point end_;
  std::atomic<bool> ringing_ = false;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable condition_;
  std::thread thread_;
};

}  // namespace lobe::meshing
