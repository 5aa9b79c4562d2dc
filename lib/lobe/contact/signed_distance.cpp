#include "lobe/contact/signed_distance.h"

#include "lobe/contact/distance_formulas.h"
#include "lobe/contact/distance_grid.h"

namespace lobe {

namespace {

Distance plain(const DistanceOf<double>& found) { return {found.value, found.gradient}; }

}  // namespace

Distance distance_to_sphere(double radius, const Vec3d& x) { return plain(sphere_distance(radius, x)); }
Distance distance_to_capsule(double radius, double length, const Vec3d& x) {
  return plain(capsule_distance(radius, length, x));
}
Distance distance_to_box(const Vec3d& half_size, const Vec3d& x) { return plain(box_distance(half_size, x)); }
Distance distance_to_jaws(const Vec3d& size, double opening, const Vec3d& x) {
  return plain(jaws_distance(size, opening, x));
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
