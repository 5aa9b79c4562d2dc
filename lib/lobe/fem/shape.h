// P1 shape functions of one tetrahedron ([PDA] section 2.1, with the sign of its erratum 2).
#pragma once

#include <Eigen/Geometry>

#include "lobe/types.h"

namespace lobe {

struct Shape {
  Mat34<double> gradients;  // α_j [1/m], one column per corner; they sum to zero
  double volume = 0;        // V [m³], > 0
};

// With D = [X1−X0, X2−X0, X3−X0], the rows of D⁻¹ are α_1, α_2, α_3, and α_0 = −(α_1 + α_2 + α_3). Those of
// D⁻¹ det D are cross products of its columns.
inline Shape shape(const Mat34<double>& X)  // 3 × 4, rest positions [m], positively oriented
{
  const Mat3<double> D = X.rightCols<3>().colwise() - X.col(0);
  Shape s;
  s.gradients.col(1) = D.col(1).cross(D.col(2));
  s.gradients.col(2) = D.col(2).cross(D.col(0));
  s.gradients.col(3) = D.col(0).cross(D.col(1));
  const double six_volumes = D.col(0).dot(s.gradients.col(1));
  s.volume = six_volumes / 6;
  s.gradients.rightCols<3>() /= six_volumes;
  s.gradients.col(0) = -s.gradients.rightCols<3>().rowwise().sum();
  return s;
}

// ∇u = Σ u_j ⊗ α_j, from differences to corner 0, so that a translation gives exactly zero.
template <class T>
Mat3<T> displacement_gradient(const Mat34<T>& u,     // 3 × 4 [m]
                              const Mat3<T>& alpha)  // α_1, α_2, α_3 [1/m]
{
  Mat3<T> d;
  for (int j = 0; j < 3; ++j) d.col(j) = u.col(j + 1) - u.col(0);
  return d.lazyProduct(alpha.transpose());
}

// Forces on the four corners, f_j = −V P α_j; f_0 is minus the sum of the others: momentum is conserved.
template <class T>
Mat34<T> corner_forces(const Mat3<T>& VP,     // V × first Piola-Kirchhoff stress [N m]
                       const Mat3<T>& alpha)  // α_1, α_2, α_3 [1/m]
{
  const Mat3<T> g = VP.lazyProduct(alpha);
  Mat34<T> f;
  f.col(0) = g.col(0) + g.col(1) + g.col(2);
  for (int j = 0; j < 3; ++j) f.col(j + 1) = -g.col(j);
  return f;
}

}  // namespace lobe
