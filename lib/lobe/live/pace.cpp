#include "lobe/live/pace.h"

namespace lobe {
namespace {

double seconds(Pace::Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

void Pace::start(Clock::time_point now) {
  due_ = now;
  simulated_ = worked_ = 0;
  factor_ = possible_ = 0;
  done_.assign(1, {now, 0, 0});
}

Pace::Clock::time_point Pace::frame_done(Clock::time_point now, double length, double speed,
                                         Clock::duration worked) {
  constexpr double window = 0.5, most_late = 0.1;  // [s]
  simulated_ += length;
  worked_ += seconds(worked);
  done_.push_back({now, simulated_, worked_});
  while (done_.size() > 2 && seconds(now - done_[1].at) >= window) done_.pop_front();
  const double wall = seconds(now - done_.front().at);
  const double simulated = simulated_ - done_.front().simulated, work = worked_ - done_.front().worked;
  factor_ = wall > 0 ? simulated / wall : 0;
  possible_ = work > 0 ? simulated / work : 0;
  due_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(length / speed));
  if (now <= due_) return due_;
  ++late_;
  if (seconds(now - due_) > most_late) due_ = now;
  return now;
}

}  // namespace lobe
