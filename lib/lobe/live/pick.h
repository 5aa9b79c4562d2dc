// Finds where a ray enters the body, for a hand that points at it.
#pragma once

#include <optional>

#include "lobe/mesh/surface.h"

namespace lobe {

struct RayHit {
  Index triangle = -1;          // triangle of the surface
  Vec3d point = Vec3d::Zero();  // [m]
};

// The first triangle that the ray enters from outside. O(#triangles).
template <class Real>
std::optional<RayHit> cast_ray(const SurfaceMesh& surface,
                               const Mat3X<Real>& x,     // 3 × #vertices of the surface [m]
                               const Vec3d& origin,      // [m]
                               const Vec3d& direction);  // direction, of any length but 0

// Whether a point lies in a tetrahedron that is alive. O(#tets).
template <class Real>
bool lies_in(const Topology& topology,
             Eigen::Ref<const Mat3X<double>> X,  // 3 × #vertices [m]
             Eigen::Ref<const Mat3X<Real>> u,    // 3 × #vertices [m]
             const Vec3d& point);                // [m]

}  // namespace lobe
