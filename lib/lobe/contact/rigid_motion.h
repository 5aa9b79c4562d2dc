// Position and velocity of a rigid tool at a moment of its path.
#pragma once

#include "lobe/tool/paths.h"
#include "lobe/tool/tool_body.h"

namespace lobe {

struct RigidMotion {
  Vec3d position = Vec3d::Zero();                    // [m]
  Mat3<double> rotation = Mat3<double>::Identity();  // turns the tool's own axes into the world's
  Vec3d velocity = Vec3d::Zero();                    // [m/s]
  Vec3d spin = Vec3d::Zero();                        // angular velocity [rad/s]
  double opening = 0, opens = 0;                     // distance of the jaws [m], and its rate [m/s]

  Vec3d velocity_at(const Vec3d& x) const { return velocity + spin.cross(x - position); }
};

// Returns position and velocity at a time; the velocity is that of the path up to then.
RigidMotion motion_at(const std::vector<PathPoint>& path, double time);
// No point of the tool within this distance of its position moves further between two times [m].
double farthest_move(const std::vector<PathPoint>& path, double from, double to, double reach);

}  // namespace lobe
