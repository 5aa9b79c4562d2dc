// Pace compares simulated time with the clock: when the next frame is due, how late a session is, how fast it
// runs. Nothing of it enters the simulation.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace lobe {

class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  // Starts to count from now: after a pause, or when the speed has changed.
  void start(Clock::time_point now);
  // Ends a frame of `length` simulated seconds, which should have taken length / speed. Returns when the next
  // should begin. If the session is more than 0.1 s late, that is at once, and time has stretched.
  Clock::time_point frame_done(Clock::time_point now, double length, double speed);

  std::int64_t frames_late() const { return late_; }
  double factor() const { return factor_; }  // simulated seconds per second, over the last half second

 private:
  struct Done {
    Clock::time_point at;
    double simulated;  // [s] since start()
  };
  Clock::time_point due_{};
  double simulated_ = 0;
  std::deque<Done> done_;  // of the last half second, and the one before
  std::int64_t late_ = 0;
  double factor_ = 0;
};

}  // namespace lobe
