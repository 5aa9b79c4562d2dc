// The local model predicts the force on a tool until the next frame. It consists of the force f_k of the last
// frame, the place at which it acted, and the stiffness of the tissue that the tool touches there,
//
//   f(x) = f_k + r τ − K (x − x_k)              of a tool that holds what it touches
//   f(x) = max(0, n·f_k − n·K n n·(x − x_k)) …   along the normal n of one that only touches it
//
// (theory, section 17). f_k is the mean over a frame, so x_k is the mean place of the tool in that frame, and
// τ the time since the middle of the frame. r is what K does not explain of how the force has changed.
#pragma once

#include <cstdint>

#include "lobe/types.h"

namespace lobe {

struct LocalModel {
  bool is_engaged = false;                  // there is a tool for the hand to lead
  std::uint32_t engagement = 0;             // counts those tools
  bool is_bilateral = true;                 // false: it only pushes, along the normal
  double frame = 1.0 / 120;                 // time between two models, by the clock [s]
  double time = 0;                          // simulated [s]
  Vec3d tool_at_end = Vec3d::Zero();        // place of the tool at the end of the frame [m]
  Eigen::Vector4d turn_at_end{0, 0, 0, 1};  // orientation of the hand then: a unit quaternion x, y, z, w
  Vec3d position = Vec3d::Zero();           // x_k [m]
  Vec3d force = Vec3d::Zero();              // f_k, the force on the tool [N]
  Vec3d rate = Vec3d::Zero();               // r, the change of the force [N/s]
  Vec3d torque = Vec3d::Zero();             // torque on the tool [N m]
  Mat3<double> K = Mat3<double>::Zero();    // symmetric, without negative eigenvalues [N/m]
  Vec3d normal = Vec3d::UnitZ();            // outward normal of the surface
};

// Returns the model `since` [s] after it came: its force is f_k + r τ, with τ since the middle of its
// frame, at most two frames.
LocalModel aged(const LocalModel& model, double since);
// Returns the force f(x) on the tool [N]. It takes model.force for f_k + r τ, so call aged() before.
Vec3d force_at(const LocalModel& model, const Vec3d& x);

struct Proxy {
  Vec3d position;  // [m]
  Vec3d force;     // force on the tool there [N]
};
// The tool between a spring of stiffness `coupling` to the device and the force of the model plus `offset`:
// where both are in balance, coupling (x_d − x_p) + f(x_p) + offset = 0.
Proxy quasi_static_proxy(const LocalModel& model, const Vec3d& device, double coupling, const Vec3d& offset);

}  // namespace lobe
