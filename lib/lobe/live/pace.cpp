#include "lobe/live/pace.h"

namespace lobe {
namespace {

double seconds(Pace::Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

void Pace::start(Clock::time_point now) {
  due_ = now;
  simulated_ = 0;
  factor_ = 0;
  done_.assign(1, {now, 0});
}

Pace::Clock::time_point Pace::frame_done(Clock::time_point now, double length, double speed) {
  constexpr double window = 0.5, most_late = 0.1;  // [s]
  simulated_ += length;
  done_.push_back({now, simulated_});
  while (done_.size() > 2 && seconds(now - done_[1].at) >= window) done_.pop_front();
  const double wall = seconds(now - done_.front().at);
  factor_ = wall > 0 ? (simulated_ - done_.front().simulated) / wall : 0;
  due_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(length / speed));
  if (now <= due_) return due_;
  ++late_;
  if (seconds(now - due_) > most_late) due_ = now;
  return now;
}

}  // namespace lobe
