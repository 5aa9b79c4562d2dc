// How far a point is from the surface of a rigid shape: negative inside. Coordinates are the shape's own.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct Distance {
  double value = 0;                 // φ [m]
  Vec3d gradient = Vec3d::UnitZ();  // ∇φ, where φ is smooth; a unit vector for spheres, capsules and boxes
};

Distance distance_to_sphere(double radius, const Vec3d& x);
// Capsule about the segment from the origin to `length` along z.
Distance distance_to_capsule(double radius, double length, const Vec3d& x);
Distance distance_to_box(const Vec3d& half_size, const Vec3d& x);
// Distance to the nearer of two boxes of this size (setup/rigid_shape.h).
Distance distance_to_jaws(const Vec3d& size, double opening, const Vec3d& x);

class DistanceGrid;

class SignedDistance {
 public:
  explicit SignedDistance(const RigidShape& shape);  // takes a checked shape; for a mesh builds a grid

  Distance at(const Vec3d& x, double opening = 0) const;  // `opening`: distance of the jaws [m]
  // True only where at() is at least `gap` ≥ 0, and cheaper than that. Of a mesh it is never true.
  bool is_beyond(const Vec3d& x, double gap, double opening) const {
    const auto is_far = [gap](const Vec3d& y, double radius) {
      return y.squaredNorm() >= (radius + gap) * (radius + gap);
    };
    const auto is_outside = [gap](const Vec3d& y, const Vec3d& half_size) {
      return (y.cwiseAbs() - half_size).maxCoeff() >= gap;
    };
    const Vec3d half_size = shape_.size / 2;
    switch (shape_.kind) {
      case RigidShape::Kind::sphere:
        return is_far(x, shape_.radius);
      case RigidShape::Kind::capsule:
        return is_far(x - Vec3d(0, 0, std::clamp(x.z(), 0.0, shape_.length)), shape_.radius);
      case RigidShape::Kind::box:
        return is_outside(x, half_size);
      case RigidShape::Kind::plane:
        return x.z() >= gap;
      case RigidShape::Kind::jaws:
        return is_outside(
            Vec3d(x.x(), std::abs(x.y()) - opening / 2, x.z()) - Vec3d(0, half_size.y(), half_size.z()),
            half_size);
      case RigidShape::Kind::mesh:
        break;
    }
    return false;
  }
  double reach() const { return reach_; }        // the farthest point of the shape from the origin [m]
  double fineness() const { return fineness_; }  // half of its least extent [m]
  double error() const { return error_; }        // by how much at() may be off [m]

 private:
  RigidShape shape_;
  double reach_, fineness_, error_ = 0;
  std::shared_ptr<const DistanceGrid> grid_;  // grid of a mesh
};

}  // namespace lobe
