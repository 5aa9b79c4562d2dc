#include "lobe/time/mass_floor.h"

#include <algorithm>
#include <cmath>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

// λ_max(K_T)/V. Corner displacements U give the gradient F = U Aᵀ with the 3 × 4 shape gradients A = Q S Wᵀ.
// In the axes of Q, F = Y S with |Y| = |U|, and the energy λ tr(F)² + 2μ |sym F|² falls apart: into the
// diagonal, with λ s sᵀ + 2μ diag(s²), and one part for each pair i < j, μ (Y_ij s_j + Y_ji s_i)² ≤ μ (s_i² +
// s_j²).
double largest_stiffness(const Elastic& e, const Mat34<double>& A) {
  const Vec3d squares = direct_symmetric_eigenvalues(A * A.transpose()).cwiseMax(0), s = squares.cwiseSqrt();
  Mat3<double> diagonal = e.lambda * s * s.transpose();
  diagonal.diagonal() += 2 * e.mu * squares;
  const double along_fibre = 2 * std::sqrt(3.0) * std::abs(e.fibre.coupling) + 4 * std::abs(e.fibre.shear) +
                             std::abs(e.fibre.stretch);
  return std::max(largest_eigenvalue(diagonal), e.mu * (squares[1] + squares[2])) + along_fibre * squares[2];
}

}  // namespace

double tet_square(const Elements& elements, Index tet) {
  const Elastic e = elements.elastic_of(tet).at_once();
  return 4 / e.density * largest_stiffness(e, elements.shape_of(tet).gradients);
}

double MassFloor::at(const Elements& elements, Index vertex, std::vector<double>* squares) const {
  if (square == 0 || elements.shares.empty()) return 0;
  const auto tets = elements.topology.around(vertex);
  if (std::none_of(tets.begin(), tets.end(), [&](Index t) { return elements.share_of(t) < 1; })) return 0;
  if (squares && squares->empty())
    squares->resize(std::size_t(elements.topology.tet_count() - elements.topology.tet_copy_count()), 0);
  const auto square_of = [&](Index t) {
    if (!squares) return tet_square(elements, t);
    double& known = (*squares)[std::size_t(elements.topology.parent(t))];
    return known > 0 ? known : known = tet_square(elements, t);
  };
  double sum = 0;
  for (Index t : tets)
    if (elements.region_of[t] != left_out)
      sum += elements.elastic_of(t).density * elements.corner_volumes[t] * square_of(t);
  return sum / square;
}

}  // namespace lobe
