// Whether a point lies in a region of space that a selector names. Surfaces belong to it.
#pragma once

#include <cmath>

#include "lobe/scene/scene.h"

namespace lobe {

inline bool is_inside(const SelectBox& box, const Vec3d& X) {
  return (X.array() >= box.min.array()).all() && (X.array() <= box.max.array()).all();
}

inline bool is_inside(const SelectSphere& sphere, const Vec3d& X) {
  return (X - sphere.center).norm() <= sphere.radius;
}

inline bool is_inside(const SelectPlane& plane, const Vec3d& X) {
  const double height = plane.normal.stableNormalized().dot(X - plane.point);
  if (plane.side == SelectPlane::Side::above) return height >= 0;
  if (plane.side == SelectPlane::Side::below) return height <= 0;
  return std::abs(height) <= plane.within;
}

}  // namespace lobe
