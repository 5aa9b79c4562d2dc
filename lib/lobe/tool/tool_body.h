// What a force term sees of a tool that touches the organ: a rigid body that moves through a frame.
#pragma once

#include <span>

#include "lobe/setup/rigid_shape.h"
#include "lobe/setup/tool_setups.h"

namespace lobe {

inline constexpr double velocity_moment = 1e-6;  // time over which velocities of tools are taken [s]

struct ToolBody {
  int tool = 0;  // ToolId
  const RigidShape* shape = nullptr;
  double friction = 0;                   // Coulomb's coefficient against tissue
  double appears = 0, goes = 0;          // times when it comes and when it goes [s]
  std::span<const PathPoint> path = {};  // rows of its path around the frame; between them it moves uniformly
};

// The contact force between a tool and the body at one moment.
struct OnTool {
  int tool = 0;
  Vec3d force = Vec3d::Zero();   // force on the body [N]
  Vec3d torque = Vec3d::Zero();  // torque on the body, about the tool's position [N m]
  double grip = 0;               // force of jaws on what is between them [N]
};

}  // namespace lobe
