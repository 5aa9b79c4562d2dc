// A haptic loop in a thread of its own, at 1 kHz. After start() it neither waits for another thread, locks,
// allocates nor writes anything but to its device.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "lobe/haptic/histogram.h"
#include "lobe/haptic/link.h"

namespace lobe {

struct LoopOptions {
  ServoOptions servo = {};
  int priority = 50;        // priority of SCHED_FIFO, where it is allowed; 0: an ordinary thread
  bool lock_memory = true;  // locks the memory of the process, where it is allowed
};

struct LoopTimes {
  Histogram lateness, compute;           // times of a tick [µs]
  std::atomic<std::uint64_t> missed{0};  // ticks left out: they would have begun after the next was due
};

class HapticLoop {
 public:
  // Throws InputError for invalid options. Device and link must live until the loop ends.
  HapticLoop(HapticDevice& device, HapticLink& link, const LoopOptions& options = {});
  ~HapticLoop() { stop(); }
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;

  void start();
  void stop();  // sets the force to none at the end

  bool is_real_time() const { return is_real_time_; }
  // Says what the system did not allow, and the consequence. Call it after start().
  const std::vector<std::string>& warnings() const { return warnings_; }
  const LoopTimes& times() const { return times_; }
  void forget_times();

 private:
  void run();
  void tick(double dt);
  void become_real_time();

  HapticDevice& device_;
  LinkedServo servo_;
  const LoopOptions options_;
  LoopTimes times_;
  std::vector<std::string> warnings_;
  std::thread thread_;
  std::atomic<bool> stops_ = false, is_ready_ = false;
  bool is_real_time_ = false;
};

}  // namespace lobe
