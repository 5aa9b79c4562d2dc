#include "lobe/contact/signed_distance.h"

#include <algorithm>

#include "lobe/contact/distance_grid.h"

namespace lobe {

Distance distance_to_sphere(double radius, const Vec3d& x) {
  const double r = x.norm();
  return {r - radius, r > 0 ? Vec3d(x * (1 / r)) : Vec3d::UnitZ()};
}

Distance distance_to_capsule(double radius, double length, const Vec3d& x) {
  return distance_to_sphere(radius, x - Vec3d(0, 0, std::clamp(x.z(), 0.0, length)));
}

// Outside the nearest point of the box, inside the nearest of its six faces.
Distance distance_to_box(const Vec3d& half_size, const Vec3d& x) {
  const Vec3d beyond = x.cwiseAbs() - half_size;
  const Vec3d sign = x.unaryExpr([](double c) { return c < 0 ? -1.0 : 1.0; });
  const Vec3d out = beyond.cwiseMax(0);
  if (const double far = out.norm(); far > 0) return {far, out.cwiseProduct(sign) / far};
  int axis;
  const double depth = beyond.maxCoeff(&axis);
  return {depth, sign[axis] * Vec3d::Unit(axis)};
}

// The one is the mirror image of the other in y = 0.
Distance distance_to_jaws(const Vec3d& size, double opening, const Vec3d& x) {
  const double side = x.y() < 0 ? -1 : 1;
  const Vec3d centre(0, (opening + size[1]) / 2, size[2] / 2);
  Distance found = distance_to_box(size / 2, Vec3d(x.x(), side * x.y(), x.z()) - centre);
  found.gradient.y() *= side;
  return found;
}

SignedDistance::SignedDistance(const RigidShape& shape)
    : shape_(shape), reach_(shape.reach()), fineness_(shape.fineness()) {
  if (shape.kind != RigidShape::Kind::mesh) return;
  grid_ = std::make_shared<const DistanceGrid>(shape.points, shape.triangles);
  error_ = grid_->cell();
}

Distance SignedDistance::at(const Vec3d& x, double opening) const {
  switch (shape_.kind) {
    case RigidShape::Kind::sphere:
      return distance_to_sphere(shape_.radius, x);
    case RigidShape::Kind::capsule:
      return distance_to_capsule(shape_.radius, shape_.length, x);
    case RigidShape::Kind::box:
      return distance_to_box(shape_.size / 2, x);
    case RigidShape::Kind::plane:
      return {x.z(), Vec3d::UnitZ()};
    case RigidShape::Kind::jaws:
      return distance_to_jaws(shape_.size, opening, x);
    case RigidShape::Kind::mesh:
      break;
  }
  return grid_->at(x);
}

}  // namespace lobe
