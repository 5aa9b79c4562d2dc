// How a body touches what is around it, and itself (contact/contact.h).
#pragma once

#include "lobe/setup/tool_setups.h"

namespace lobe {

// A rigid body that does not move, such as a table or the wall of a cavity.
struct ObstacleSetup {
  std::string name = "obstacle";
  RigidShape shape;
  Vec3d position = Vec3d::Zero();           // [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  double friction = default_friction;       // Coulomb's coefficient against tissue
  void check(const Expect& expect) const;
  static constexpr auto fields = std::tuple(&ObstacleSetup::shape, &ObstacleSetup::position,
                                            &ObstacleSetup::orientation, &ObstacleSetup::friction);
};

struct ContactSetup {
  bool self = false;                   // organ against organ, the lips of cuts, pieces that fall
  double friction = default_friction;  // Coulomb's coefficient of tissue against tissue
  // Damping of the normal speed in contact, as a share of the critical damping at the highest frequency of
  // the body. At lower frequencies it is less.
  double damping = 0.05;
  std::vector<ObstacleSetup> obstacles;
  bool is_on() const { return self || !obstacles.empty(); }  // without any tool
  void check(const Expect& expect) const;
  static constexpr auto fields = std::tuple(&ContactSetup::self, &ContactSetup::friction,
                                            &ContactSetup::damping, &ContactSetup::obstacles);
};

}  // namespace lobe
