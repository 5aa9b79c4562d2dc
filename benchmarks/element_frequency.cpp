#include "benchmarks/element_frequency.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "benchmarks/benchmarks.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/solve/quadratic_tangent.h"

namespace lobe::bench {
namespace {

using MassMatrix = Eigen::SparseMatrix<double>;

// By iteration of a subspace with K⁻¹ M; K Y = M X, so that YᵀM X is the stiffness on the subspace.
template <class SomeTangent>
double lowest_of(SomeTangent& tangent, const MassMatrix& M) {
  constexpr int iterations = 20, block = 6;
  const auto factor = tangent.make_factor(make_supernodal);
  bool damped = false;
  if (!tangent.factorise(*factor, damped) || damped)
    throw WrongResult("elements: a body is not stable at rest");
  Eigen::MatrixXd X(M.rows(), block), Y(M.rows(), block);
  for (Eigen::Index j = 0; j < block; ++j)
    for (Eigen::Index i = 0; i < M.rows(); ++i) X(i, j) = std::sin(1.7 * double(i * (j + 1)) + double(j));
  double square = 0;
  for (int i = 0; i < iterations; ++i) {
    const Eigen::MatrixXd MX = M * X;
    for (Eigen::Index j = 0; j < block; ++j) Y.col(j) = tangent.solve(*factor, Eigen::VectorXd(MX.col(j)));
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(Y.transpose() * MX,
                                                                          Y.transpose() * (M * Y));
    square = small.eigenvalues()[0];
    X = Y * small.eigenvectors();
  }
  return std::sqrt(square);
}

// ∫ N_m N_n over a tetrahedron is V/420 times this: of two corners, of a corner and an edge, of two edges.
int shape_product(int m, int n) {
  if (m > n) std::swap(m, n);
  if (n < 4) return m == n ? 6 : 1;
  const auto [i, j] = edge_corners[n - 4];
  if (m < 4) return m == i || m == j ? -4 : -6;
  if (m == n) return 32;
  const auto [k, l] = edge_corners[m - 4];
  return i == k || i == l || j == k || j == l ? 16 : 8;
}

MassMatrix consistent_mass(const Elements& elements, const QuadraticMesh& mesh, const Unknowns& unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const double unit = elements.volume(t) * elements.elastic_of(t).density / 420;
    for (int m = 0; m < 10; ++m)
      for (int n = 0; n < 10; ++n)
        for (int axis = 0; axis < 3; ++axis) {
          const Index row = unknowns.number(axis, mesh.nodes(m, t)),
                      column = unknowns.number(axis, mesh.nodes(n, t));
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, unit * shape_product(m, n));
        }
  }
  MassMatrix M(unknowns.count, unknowns.count);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

}  // namespace

double lowest_frequency(const Setup& setup) {
  const Elements elements(setup);
  const Unknowns unknowns = free_components(elements, held_by(setup.prescribed));
  Mat3X<double> masses(3, setup.mesh.vertex_count());
  for (Index v = 0; v < masses.cols(); ++v) masses.col(v).setConstant(lumped_mass(elements, v));
  const Eigen::VectorXd diagonal = unknowns.gather(masses);
  Tangent tangent(elements, unknowns);
  tangent.update(Mat3X<double>::Zero(3, setup.mesh.vertex_count()));
  return lowest_of(tangent, MassMatrix(diagonal.asDiagonal()));
}

double lowest_quadratic_frequency(const Setup& setup) {
  const Elements elements(setup);
  const QuadraticMesh mesh(setup.mesh);
  const Unknowns unknowns = quadratic_equations(setup, mesh).unknowns;
  QuadraticTangent tangent(elements, mesh, unknowns);
  tangent.update(Mat3X<double>::Zero(3, mesh.node_count()));
  return lowest_of(tangent, consistent_mass(elements, mesh, unknowns));
}

}  // namespace lobe::bench
