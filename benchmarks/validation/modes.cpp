#include "benchmarks/validation/modes.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>

#include "lobe/solve/tangent.h"

namespace lobe::validation {
namespace {

using Vector = Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

struct Vibration {
  explicit Vibration(const Setup& setup);

  std::vector<Index> unknown;  // per vertex: the first of its three, −1 where held
  Sparse stiffness;            // lower triangle [N/m]
  Vector mass;                 // [kg]
};

Vibration::Vibration(const Setup& setup) : unknown(std::size_t(setup.mesh.vertex_count()), 0) {
  const Elements elements(setup);
  for (const PrescribedVertex& p : setup.prescribed) unknown[p.vertex] = -1;
  Index count = 0;
  for (Index& u : unknown)
    if (u >= 0) {
      u = count;
      count += 3;
    }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const TetStiffness K = tet_stiffness(elements, t, Mat34<double>::Zero());
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) {
        const Index row = unknown[setup.mesh.tets(i / 3, t)], column = unknown[setup.mesh.tets(j / 3, t)];
        if (row >= 0 && column >= 0 && row + i % 3 >= column + j % 3)
          entries.emplace_back(row + i % 3, column + j % 3, K(i, j));
      }
  }
  stiffness.resize(count, count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  mass.resize(count);
  for (std::size_t v = 0; v < unknown.size(); ++v)
    if (unknown[v] >= 0) mass.segment<3>(unknown[v]).setConstant(lumped_mass(elements, Index(v)));
}

// The factor of K − σM is indefinite; it needs no pivoting as long as σ is not an eigenvalue to the last digit.
Vector solve_shifted(const Vibration& body, double shift, const Vector& right) {
  Sparse A = body.stiffness;
  A.diagonal() -= shift * body.mass;
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(A);
  if (factor.info() != Eigen::Success) throw std::runtime_error("modes: K − σM could not be factorised");
  return factor.solve(right);
}

}  // namespace

Mode mode_like(const Setup& setup, const Mat3X<double>& guess) {
  const Vibration body(setup);
  Vector x(body.mass.size());
  for (std::size_t v = 0; v < body.unknown.size(); ++v)
    if (body.unknown[v] >= 0) x.segment<3>(body.unknown[v]) = guess.col(Eigen::Index(v));
  const auto normalise = [&](Vector& y) { y /= std::sqrt(y.cwiseProduct(body.mass).dot(y)); };
  normalise(x);
  const Vector start = x;
  double square = 0;
  for (int i = 0;; ++i) {
    const Vector Kx = body.stiffness.selfadjointView<Eigen::Lower>() * x, Mx = body.mass.cwiseProduct(x);
    square = x.dot(Kx);
    if ((Kx - square * Mx).norm() < 1e-6 * Kx.norm()) break;
    if (i == 30) throw std::runtime_error("modes: Rayleigh quotient iteration did not converge");
    x = solve_shifted(body, square, Mx);
    normalise(x);
  }
  Mode mode{std::sqrt(square), Mat3X<double>::Zero(3, guess.cols()),
            std::abs(start.cwiseProduct(body.mass).dot(x))};
  for (std::size_t v = 0; v < body.unknown.size(); ++v)
    if (body.unknown[v] >= 0) mode.shape.col(Eigen::Index(v)) = x.segment<3>(body.unknown[v]);
  mode.shape /= mode.shape.colwise().norm().maxCoeff();
  return mode;
}

}  // namespace lobe::validation
