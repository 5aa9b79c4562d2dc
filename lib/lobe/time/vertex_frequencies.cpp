#include "lobe/time/vertex_frequencies.h"

#include <cmath>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/forces/region_list.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {

CornerStiffness corner_stiffness(const Elements& elements, Index tet, const Mat34<double>& u) {
  const Shape s = elements.shape_of(tet);
  const bool linear = is_always_linear(elements.region_of[tet]);
  const Law<double> law = linear ? linear_law(elements, tet) : nonlinear_law(elements, tet);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  CornerStiffness K;
  for (int c = 0; c < 4; ++c) {
    const Vec3d a = s.gradients.col(c);
    const Mat3<double> B = linear ? linear_block(law, a, a) : law_diagonal_block(law, H, a);
    K.col(c) << B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2);
  }
  return s.volume * K;
}

// With q = tr K/3 and p² = |K − qI|²/6 the eigenvalues of a symmetric 3 × 3 matrix are q + 2p cos φ at three
// angles.
template <class Real>
double VertexFrequencies<Real>::bound(Index v) const {
  const auto K = stiffness(v);
  const double q = (K[0] + K[3] + K[5]) / 3;
  const double off = K[1] * K[1] + K[2] * K[2] + K[4] * K[4];
  const double on = (K[0] - q) * (K[0] - q) + (K[3] - q) * (K[3] - q) + (K[5] - q) * (K[5] - q);
  return std::max(0.0, q + 2 * std::sqrt((on + 2 * off) / 6));
}

template <class Real>
double VertexFrequencies<Real>::exact_square(Index v, double weight) const {
  const auto K = stiffness(v);
  Mat3<double> block;
  block << K[0], K[1], K[2], K[1], K[3], K[4], K[2], K[4], K[5];
  return std::max(0.0, largest_eigenvalue(block)) * weight;
}

template class VertexFrequencies<float>;
template class VertexFrequencies<double>;

}  // namespace lobe
