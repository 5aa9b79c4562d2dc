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

  Unknowns unknowns;
  Sparse stiffness;  // lower triangle [N/m]
  Vector mass;       // [kg]
};

Vibration::Vibration(const Setup& setup)
    : unknowns(free_components(Elements(setup), held_by(setup.prescribed))) {
  const Elements elements(setup);
  Tangent tangent(elements, unknowns);
  tangent.update(Mat3X<double>::Zero(3, setup.mesh.vertex_count()));
  stiffness = tangent.matrix();
  Mat3X<double> masses(3, setup.mesh.vertex_count());
  for (Index v = 0; v < masses.cols(); ++v) masses.col(v).setConstant(lumped_mass(elements, v));
  mass = unknowns.gather(masses);
}

// The factor of K − σM is indefinite; it needs no pivoting as long as σ is not an eigenvalue to the last
// digit.
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
  Vector x = body.unknowns.gather(guess);
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
  Mode mode{std::sqrt(square), body.unknowns.scatter(x), std::abs(start.cwiseProduct(body.mass).dot(x))};
  mode.shape /= mode.shape.colwise().norm().maxCoeff();
  return mode;
}

}  // namespace lobe::validation
