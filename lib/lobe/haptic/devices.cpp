#include "lobe/haptic/devices.h"

#include <algorithm>

namespace lobe {

bool MouseDevice::read(DeviceState& state) noexcept {
  constexpr HandLimits limits{.lag = 0.04, .top_speed = 0.5, .top_turn = 10, .force_cap = 1};
  const PointerTarget::At target = target_.read();
  if (!is_there_ && !target) return false;
  if (!std::exchange(is_there_, true)) filter_ = PoseFilter(*target);
  const Vec3d before = filter_.pose().position;
  if (target) filter_.aim({*target});
  if (!std::exchange(begins_, false)) filter_.step(tick_, limits);
  state.position = filter_.pose().position;
  state.velocity = (state.position - before) / tick_;
  return true;
}

void MouseDevice::begin_at(const Vec3d& tool) noexcept {
  filter_ = PoseFilter(tool);
  is_there_ = begins_ = true;
}

SimulatedHand::SimulatedHand(const Mechanics& mechanics, Path path, double tick)
    : mechanics_(mechanics), path_(std::move(path)), tick_(tick) {}

bool SimulatedHand::read(DeviceState& state) noexcept {
  constexpr int parts = 20;
  const PointerTarget::At target = path_ ? path_(time_) : target_.read();
  if (!is_there_ && !target) return false;
  if (target) goal_ = *target;
  if (!std::exchange(is_there_, true)) position_ = goal_;
  for (int i = 0; i < parts; ++i) move(tick_ / parts);
  if (!is_plugged_) return false;
  state.position = position_;
  state.velocity = velocity_;
  return true;
}

void SimulatedHand::begin_at(const Vec3d& tool) noexcept {
  if (path_) return;
  position_ = goal_ = tool;
  velocity_.setZero();
  is_there_ = true;
}

// The spring of the hand pulls by its position, the dampers by their velocities, the force of the device is
// that of the last tick.
void SimulatedHand::move(double dt) {
  const Vec3d before = goal_;
  time_ += dt;
  if (path_) goal_ = path_(time_);
  const Vec3d path_velocity = path_ ? Vec3d((goal_ - before) / dt) : Vec3d::Zero();
  const Vec3d grip =
      mechanics_.grip * (goal_ - position_) + mechanics_.grip_damping * (path_velocity - velocity_);
  velocity_ += dt / mechanics_.mass * (force_ + grip - mechanics_.damping * velocity_);
  position_ += dt * velocity_;
}

double SimulatedHand::energy() const {
  return 0.5 * mechanics_.mass * velocity_.squaredNorm() +
         0.5 * mechanics_.grip * (goal_ - position_).squaredNorm();
}

const HapticState& ExternalDevice::force(const DeviceState* device) {
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - last_).count();
  const double dt = std::exchange(is_running_, true) ? std::clamp(since, 1e-5, 0.1) : tick_;
  last_ = now;
  return servo_.tick(device, dt);
}

}  // namespace lobe
