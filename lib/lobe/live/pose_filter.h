// Makes a tool follow a hand smoothly, and no faster than a hand moves. The body is moved by the tool, not by
// the hand itself.
#pragma once

#include "lobe/tool/tools.h"

namespace lobe {

struct HandLimits {
  double lag = 0.04;       // time by which the tool trails a hand that moves uniformly [s]
  double top_speed = 0.5;  // top speed of the tool [m/s]
  double top_turn = 10;    // [rad/s]
  double force_cap = 20;   // force above which a grasp slips off [N]
};

class PoseFilter {
 public:
  PoseFilter() = default;
  explicit PoseFilter(const Vec3d& position) { now_.position = target_.position = position; }

  void aim(const ToolPose& target) { target_ = target; }
  // Moves the tool by dt [s]. False if it rests at its target.
  bool step(double dt, const HandLimits& limits);
  // Moves the tool without a lag, for a device whose motion is smooth by itself.
  bool step_without_lag(double dt, const HandLimits& limits);
  const ToolPose& pose() const { return now_; }

 private:
  ToolPose now_, target_;
  Vec3d velocity_ = Vec3d::Zero(), spin_ = Vec3d::Zero();  // [m/s], [rad/s]
};

}  // namespace lobe
