// How far a point is from the surface of a rigid shape: negative inside. Coordinates are the shape's own.
#pragma once

#include <memory>

#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct Distance {
  double value = 0;                 // φ [m]
  Vec3d gradient = Vec3d::UnitZ();  // ∇φ, where φ is smooth; a unit vector for spheres, capsules and boxes
};

Distance distance_to_sphere(double radius, const Vec3d& x);
// About the segment from the origin to `length` along z.
Distance distance_to_capsule(double radius, double length, const Vec3d& x);
Distance distance_to_box(const Vec3d& half_size, const Vec3d& x);
// To the nearer of two boxes of this size (setup/rigid_shape.h).
Distance distance_to_jaws(const Vec3d& size, double opening, const Vec3d& x);

class DistanceGrid;

class SignedDistance {
 public:
  explicit SignedDistance(const RigidShape& shape);  // which has been checked; of a mesh: builds a grid

  Distance at(const Vec3d& x, double opening = 0) const;  // of jaws [m]
  double reach() const { return reach_; }        // the farthest point of the shape from the origin [m]
  double fineness() const { return fineness_; }  // half of its least extent [m]
  double error() const { return error_; }        // by how much at() may be off [m]

 private:
  RigidShape shape_;
  double reach_, fineness_, error_ = 0;
  std::shared_ptr<const DistanceGrid> grid_;  // of a mesh
};

}  // namespace lobe
