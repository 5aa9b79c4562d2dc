// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <Eigen/Geometry>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// [m²] of all triangles.
inline double area(const Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles.colwise()) {
    const Vec3d a = surface.points.col(t[1]) - surface.points.col(t[0]);
    sum += a.cross(Vec3d(surface.points.col(t[2]) - surface.points.col(t[0]))).norm() / 2;
  }
  return sum;
}

}  // namespace lobe::meshing
