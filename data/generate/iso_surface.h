// From a formula to triangles, and the checks that every file of data/ passes.
#pragma once

#include <functional>
#include <string>

#include "organs.h"

namespace organs {

using Formula = std::function<double(const Vec3&)>;

// The surface formula(p) = 0 inside the box, which it must not touch, as almost equilateral triangles with
// the given edge length [m]: VTK's marching cubes on a finer grid, CGAL's isotropic remeshing, then every
// vertex put back on the zero set along the gradient. The same triangles at every run.
Surface iso_surface(const Formula& formula, const Eigen::AlignedBox3d& box, double edge);

struct SurfaceReport {
  bool closed = false;             // every edge has two triangles; one connected manifold
  bool self_intersecting = false;  // two triangles that are not neighbours meet
  double volume = 0;               // [m³], positive if the triangles are oriented outwards
  double smallest_angle = 0;       // [degrees]
  Vec3 size = Vec3::Zero();        // of the bounding box [m]
};
SurfaceReport inspect(const Surface& surface);

}  // namespace organs
