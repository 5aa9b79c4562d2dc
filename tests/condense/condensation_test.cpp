#include "lobe/condense/condensation.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>

using namespace lobe;

namespace {

using Exact = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

// Springs in a row, the first one from what stays where it is to point 0, the k-th to point k.
struct Chain {
  Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(20);  // [N/m]

  SparseFactor::Matrix matrix() const {
    const Eigen::Index n = stiffness.size();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index k = 0; k < n; ++k) K(k, k) = stiffness[k] + (k + 1 < n ? stiffness[k + 1] : 0);
    for (Eigen::Index k = 1; k < n; ++k) K(k, k - 1) = -stiffness[k];
    return K.sparseView();
  }

  // Displacements with a force on each point but the first, which is driven.
  Exact field(double force, double led) const {
    const Eigen::Index n = stiffness.size();
    Exact u = Exact::Constant(n, led);
    for (Eigen::Index k = 1; k < n; ++k)
      u[k] = u[k - 1] + static_cast<long double>(force) * static_cast<long double>(n - k) / stiffness[k];
    return u;
  }

  double energy(const Exact& u) const {  // of the springs between points, twice
    long double sum = 0;
    for (Eigen::Index k = 1; k < stiffness.size(); ++k)
      sum += static_cast<long double>(stiffness[k]) * (u[k] - u[k - 1]) * (u[k] - u[k - 1]);
    return double(sum);
  }
};

Condensation condensed(const Chain& chain) {
  auto factor = make_ldlt();
  const SparseFactor::Matrix K = chain.matrix();
  factor->analyse(K);
  REQUIRE(factor->factorise(K));
  Eigen::MatrixXd loads = Eigen::MatrixXd::Ones(chain.stiffness.size(), 2);
  loads.row(0).setZero();
  loads.col(1) *= -1;  // as dead loads that are missing at first
  Condensation condensed(std::move(factor), loads);
  condensed.promote({0});
  return condensed;
}

}  // namespace

TEST_CASE("what edits have cost a condensed structure is measured: its distance from the exact solution") {
  Chain chain;
  Condensation chain_as_cut = condensed(chain);
  CHECK(chain_as_cut.error() < 1e-14);
  double before = 0;
  for (const double left : {1e-1, 1e-3, 1e-4}) {
    CAPTURE(left);
    for (const Index k : {6, 7, 12}) {  // nearly all of a spring goes; what is left behind it hangs on little
      const double goes = chain.stiffness[k] * (1 - left);
      chain.stiffness[k] -= goes;
      Eigen::Matrix2d change;
      change << -goes, goes, goes, -goes;
      REQUIRE(chain_as_cut.change({k - 1, k}, change, Eigen::MatrixXd::Zero(2, 2)));
    }
    const Eigen::VectorXd field = chain_as_cut.field(Eigen::Vector3d(1, 0, 0));
    const Exact exact = chain.field(1, 0);
    const double distance = std::sqrt(chain.energy(field.cast<long double>() - exact) / chain.energy(exact));
    CHECK(chain_as_cut.error() > distance / 2);
    CHECK(chain_as_cut.error() < 2 * distance);
    CHECK(distance > before);
    before = distance;
  }
  CHECK(before > 1e-10);
}
