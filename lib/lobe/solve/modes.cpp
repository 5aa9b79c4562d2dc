#include "lobe/solve/modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/solve/static_equations.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

constexpr int most_subspaces = 300;
constexpr double last_growth = 1e-11;  // of the squares, between two iterations, relative

}  // namespace

Eigen::VectorXd lowest_frequencies(const Setup& setup, const Mat3X<double>& u, int count,
                                   const SparseFactorMaker& make) {
  const Elements elements(setup);
  const StaticEquations equations = static_equations(setup, elements);
  const Index unknowns = equations.unknowns.count;
  if (count > unknowns)
    throw InputError("frequencies", "the body has only " + std::to_string(unknowns) + " of them");
  Mat3X<double> masses(3, u.cols());
  for (Index v = 0; v < masses.cols(); ++v) masses.col(v).setConstant(lumped_mass(elements, v));
  const Eigen::VectorXd mass = equations.unknowns.gather(masses);
  Tangent tangent(elements, equations.unknowns);
  tangent.update(u);
  if (equations.stiffness.cols() > 0) tangent.add_diagonal(equations.stiffness);
  const auto factor = tangent.make_factor(make);
  bool damped = false;
  if (!tangent.factorise(*factor, damped) || damped)
    throw InputError("equilibrium", "is not stable, so that it has no frequencies");
  const Index block = std::min<Index>(unknowns, 2 * count + 6);
  Eigen::MatrixXd X(unknowns, block), Y(unknowns, block);
  for (Eigen::Index j = 0; j < block; ++j)
    for (Eigen::Index i = 0; i < unknowns; ++i) X(i, j) = std::sin(1.7 * double(i * (j + 1)) + double(j));
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(count);
  for (int i = 0; i < most_subspaces; ++i) {
    const Eigen::MatrixXd MX = mass.asDiagonal() * X;
    for (Eigen::Index j = 0; j < block; ++j) Y.col(j) = tangent.solve(*factor, Eigen::VectorXd(MX.col(j)));
    // K Y = M X, so that YᵀM X is the stiffness on the subspace.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(
        Y.transpose() * MX, Y.transpose() * (mass.asDiagonal() * Y));
    const Eigen::VectorXd now = small.eigenvalues().head(count);
    X = Y * small.eigenvectors();
    const bool is_last = (now - squares).cwiseAbs().maxCoeff() <= last_growth * now.cwiseAbs().maxCoeff();
    squares = now;
    if (is_last) return squares.cwiseSqrt();
  }
  throw InputError("frequencies", "were not found in " + std::to_string(most_subspaces) + " iterations");
}

}  // namespace lobe
