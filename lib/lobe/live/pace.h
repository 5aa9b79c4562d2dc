// Pace compares simulated time with the clock: when the next frame is due, how late a session is, how fast
// it runs. Nothing of it enters the simulation.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace lobe {

class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  // Counts from now on. Call it after a pause, or when the speed has changed.
  void start(Clock::time_point now);
  // Ends a frame of `length` simulated seconds, for which `worked` was spent and which should have taken
  // length / speed. Returns when the next should begin. If the session is more than 0.1 s late, the next
  // frame begins at once, and the time that was lost is not made up for.
  Clock::time_point frame_done(Clock::time_point now, double length, double speed, Clock::duration worked);

  std::int64_t frames_late() const { return late_; }
  // Speeds over the last half second. factor(): simulated seconds per second of the clock. The other: per
  // second of work, which a session could reach without waiting.
  double factor() const { return factor_; }
  double possible_factor() const { return possible_; }

 private:
  struct Done {
    Clock::time_point at;
    double simulated;  // [s] since start()
    double worked;     // [s]
  };
  Clock::time_point due_{};
  double simulated_ = 0, worked_ = 0;
  std::deque<Done> done_;  // frames of the last half second, and the one before
  std::int64_t late_ = 0;
  double factor_ = 0, possible_ = 0;
};

}  // namespace lobe
