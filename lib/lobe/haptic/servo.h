// A servo computes one tick of a haptic loop: from the pose of the hand to the force on it. It does not wait,
// lock, allocate or throw. One thread uses it.
//
// A spring couples the device to the tool. The hand feels the force where that spring and the local model
// are in balance (local_model.h). The tool follows the device at once, and goes to the place of balance
// slowly. A new model is blended in, so that the force is continuous. One that is too old fades away. The
// force is passive (passivity.h) and within the limits of the device.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "lobe/haptic/local_model.h"
#include "lobe/haptic/passivity.h"

namespace lobe {

// A tool is at origin + rotation · scale · (position of the device); forces go back by the same rotation,
// times `force_gain`. A turn of the device about an axis turns the tool by as much about rotation · axis.
struct Workspace {
  Vec3d origin = Vec3d::Zero();  // [m]
  Mat3<double> rotation = Mat3<double>::Identity();
  double scale = 1, force_gain = 1;
};

struct ServoOptions {
  double tick = 1e-3;              // time between two ticks [s]
  double bound_share = 0.8;        // stiffness of the coupling over Colgate's bound 2 (b − |B|)/T [-]
  double coupling_damping = 0.25;  // B, as a share of the device's damping b, 0 … 0.25 [-]
  // After a new model, the force changes over to it in |difference|/blend_rate, measured at the hand [N/s],
  // but in no more than longest_blend [s] or a frame.
  double longest_blend = 4e-3;
  double blend_rate = 5;
  double stale_frames = 3;     // age at which a model begins to fade [frames]
  double fade = 0.05;          // time in which the force then fades to nothing [s]
  double settling_frames = 6;  // time constant of the tool's way from the device to where it is in balance
  double highest_damping = 5;  // most damping of the passivity controller [N s/m]; 0: it only observes
  double passivity_deadband = 5e-6;  // energy that may come out before the controller acts [J]
  double most_active = 5e-5;         // energy beyond which the force is lowered: damping does too little [J]
  Workspace workspace = {};
};

// The state of a loop, for other threads.
struct HapticState {
  std::uint64_t ticks = 0;
  DeviceState device;                       // state read last
  bool is_there = false;                    // whether the device is there
  std::uint32_t engagement = 0;             // LocalModel::engagement of the tool that is led; 0: none is led
  Vec3d tool = Vec3d::Zero();               // place at which the tool is to be [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // orientation of the tool: a unit quaternion x, y, z, w
  Vec3d force = Vec3d::Zero();              // force on the hand, as sent to the device [N]
  Vec3d torque = Vec3d::Zero();             // [N m]
  double coupling = 0;                      // [N/m]
  double energy = 0;                        // energy of the passivity observer [J]
  std::uint64_t interventions =
      0;                        // ticks in which the passivity controller added damping or lowered the force
  std::uint64_t stale = 0;      // ticks on a model that was too old
  std::uint64_t stalls = 0;     // how often a model became so old that its force was gone
  std::uint64_t bad_poses = 0;  // ticks with a pose that is not finite
  std::uint64_t absent = 0;     // ticks without a device
  std::uint64_t limited = 0;    // ticks in which the force or its change was cut off
};

class Servo {
 public:
  // Throws InputError for invalid options or limits.
  Servo(const DeviceLimits& limits, const ServoOptions& options);

  // `device`: null if it is not there. `model`: the latest one; by its time it is the same as before or new.
  // `dt`: time since the last tick [s].
  const HapticState& tick(const DeviceState* device, const LocalModel& model, double dt);
  const HapticState& state() const { return state_; }

 private:
  void take_pose(const DeviceState* device, double dt);
  void begin_here(const Vec3d& position, const Eigen::Quaterniond& turn);
  void take_model(const LocalModel& model, double dt);
  void take_up(const LocalModel& model);
  Vec3d wanted_force(double dt);
  void send(const Vec3d& force, const Vec3d& torque, double dt);
  Vec3d tool_of(const Vec3d& device) const;
  Eigen::Quaterniond turn_of_tool() const;
  double lead() const;
  void settle(const Vec3d& device, double dt);
  void limit_activity(double storable, double dt);
  double storable(const Vec3d& force) const;

  DeviceLimits limits_;
  ServoOptions options_;
  double damping_;   // damping of the coupling [N s/m]
  double coupling_;  // stiffness in the units of the tool [N/m]
  LocalModel model_;
  Vec3d clutch_ = Vec3d::Zero();  // vector added to the device's place, to take up tools where they are
  Eigen::Quaterniond device_turn_, tool_turn_;  // orientations when the tool was taken up
  Vec3d offset_ = Vec3d::Zero();    // force before the last model came, less that of the model [N]
  Vec3d blended_ = Vec3d::Zero();   // the part of offset_ that is left [N]
  double blend_ = 0;                // time that the blending takes [s]
  Vec3d proxy_ = Vec3d::Zero();     // place where the tool would be in balance [m]
  Vec3d settled_ = Vec3d::Zero();   // way that the tool has gone from the device to there [m]
  Vec3d unloaded_ = Vec3d::Zero();  // place where the tool was in balance when it last felt nothing [m]
  double since_model_ = 0;          // [s]
  double trust_ = 0;                // trust in pose and model: 1 while they are fresh, then fading
  double share_ = 1;                // share of the force that the hand feels; below 1 if damping fails
  bool is_fresh_ = false;           // whether the pose is fresh
  bool awaits_pose_ = false;        // whether there was no pose when the tool was taken up
  bool was_gone_ = false;           // whether the force was gone, because the model was too old
  Passivity passivity_;
  HapticState state_;
};

}  // namespace lobe
