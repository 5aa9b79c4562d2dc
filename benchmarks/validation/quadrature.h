// Integration over tetrahedra (degree 5) and triangles (degree 4).
#pragma once

#include <vector>

#include "lobe/types.h"

namespace lobe::validation {

struct TetPoint {
  Eigen::Vector4d barycentric;
  double weight = 0;  // they add up to 1
};
// 14 points, exact to degree 5; N. J. Walkington, Quadrature on simplices of arbitrary dimension, 2000.
const std::vector<TetPoint>& tet_quadrature();

struct TrianglePoint {
  Vec3d barycentric;
  double weight = 0;  // they add up to 1
};
// 6 points, exact to degree 4; D. A. Dunavant, Int. J. Numer. Meth. Eng. 21, 1985.
const std::vector<TrianglePoint>& triangle_quadrature();

}  // namespace lobe::validation
