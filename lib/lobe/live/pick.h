// Finds where a ray enters the body, for a hand that points at it.
#pragma once

#include <optional>

#include "lobe/mesh/surface.h"

namespace lobe {

struct RayHit {
  Index triangle = -1;          // of the surface
  Vec3d point = Vec3d::Zero();  // [m]
};

// The first triangle that the ray enters from outside. O(#triangles).
template <class Real>
std::optional<RayHit> cast_ray(const SurfaceMesh& surface,
                               const Mat3X<Real>& x,     // 3 × #vertices of the surface [m]
                               const Vec3d& origin,      // [m]
                               const Vec3d& direction);  // of any length but 0

}  // namespace lobe
