// Simulated time against the clock: when the next frame is due, how far behind a session is, and how fast it
// really is. Nothing of it enters the simulation.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace lobe {

class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  // Frames are due from now on; after a pause, and where the speed has changed.
  void start(Clock::time_point now);
  // A frame of so many simulated seconds has ended, for which `worked` was spent; it should have taken
  // length / speed. When the next should begin: where the session is more than 0.1 s late, at once, and time
  // has stretched.
  Clock::time_point frame_done(Clock::time_point now, double length, double speed, Clock::duration worked);

  std::int64_t frames_late() const { return late_; }
  // Over the last half second: simulated seconds per second; and per second of work, which a session could
  // reach that does not wait.
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
  std::deque<Done> done_;  // of the last half second, and the one before
  std::int64_t late_ = 0;
  double factor_ = 0, possible_ = 0;
};

}  // namespace lobe
