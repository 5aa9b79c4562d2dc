// Distances between an instrument and a tetrahedron.
#pragma once

#include "lobe/types.h"

namespace lobe {

// The point of triangle (a, b, c) nearest to p, by the Voronoi regions of its vertices and edges. [m]
Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

// Distance from p to the segment from a to b, which may be a point. [m]
double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b);

// Distance from p to a tetrahedron of any orientation, 0 inside. [m]
double distance_to_tet(const Vec3d& p, const Mat34<double>& corners);

}  // namespace lobe
