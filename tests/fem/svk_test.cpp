#include "lobe/fem/svk.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fem/moduli.h"
#include "lobe/fem/shape.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {
constexpr double E = 28000, nu = 0.4;
Mat3<double> less_identity(const Mat3<double>& F) { return F - Mat3<double>::Identity(); }
}  // namespace

TEST_CASE("uniaxial stretch with free sides follows P = E s (s² − 1)/2") {
  const double table[][2] = {{0.5, -0.1875}, {0.57735, -0.19245}, {0.7, -0.1785}, {0.9, -0.0855},
                             {1.1, 0.1155},  {1.3, 0.4485},       {1.5, 0.9375}};
  for (const auto& [s, P_over_E] : table) {
    // The lateral stretch is imaginary beyond s² = 1 + 1/ν; the table stays below it.
    const double side = std::sqrt(1 - nu * (s * s - 1));
    const Mat3<double> P = svk_stress(less_identity(Vec3d(s, side, side).asDiagonal()), lambda, mu);
    CHECK(P(0, 0) / E == near(P_over_E, 1e-5));
    CHECK(std::abs(P(1, 1)) < 1e-9 * E);
    CHECK(std::abs(P(2, 2)) < 1e-9 * E);
  }
}

TEST_CASE("simple shear follows the closed form") {
  struct Row {
    double g, P12, P21, P11, P33, W;
  };
  for (const Row& r : {Row{0.1, 1030, 1000, 300, 200, 50.75}, Row{0.5, 8750, 5000, 7500, 5000, 1718.75},
                       Row{1.0, 40000, 10000, 30000, 20000, 12500}}) {
    Mat3<double> H = Mat3<double>::Zero();
    H(0, 1) = r.g;
    const Mat3<double> P = svk_stress(H, lambda, mu);
    CHECK(P(0, 1) == near(r.P12, 1e-12));
    CHECK(P(1, 0) == near(r.P21, 1e-12));
    CHECK(P(0, 0) == near(r.P11, 1e-12));
    CHECK(P(1, 1) == near(r.P11, 1e-12));
    CHECK(P(2, 2) == near(r.P33, 1e-12));
    CHECK(svk_energy_density(H, lambda, mu) == near(r.W, 1e-12));
  }
}

TEST_CASE("hydrostatic stretch follows P = (3λ + 2μ) s (s² − 1)/2") {
  for (double s : {0.6, 0.9, 1.2, 2.0}) {
    const Mat3<double> P = svk_stress(less_identity(s * Mat3<double>::Identity()), lambda, mu);
    const double exact = (3 * lambda + 2 * mu) * s * (s * s - 1) / 2;
    CHECK((P - exact * Mat3<double>::Identity()).norm() < 1e-10 * std::abs(exact));
  }
}

TEST_CASE("code_aster SSNV121: rotation and stretch 1.1 in uniaxial strain gives 31096.154 MPa") {
  const double young = 2e5, poisson = 0.3;
  const double l = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), m = young / (2 * (1 + poisson));
  const Mat3<double> R = Eigen::AngleAxisd(1.1, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3<double> F = R * Vec3d(1.1, 1, 1).asDiagonal();
  const Mat3<double> P = R.transpose() * svk_stress(less_identity(F), l, m);
  CHECK(P(0, 0) == near(31096.154, 1e-7));
}

TEST_CASE("a rigid rotation by any angle gives no SVK stress and no energy") {
  for (double angle : {0.1, 1.0, 2.0, 3.14159}) {
    const Mat3<double> R = Eigen::AngleAxisd(angle, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
    CHECK(svk_stress(less_identity(R), lambda, mu).norm() < 1e-10);
    CHECK(std::abs(svk_energy_density(less_identity(R), lambda, mu)) < 1e-20);
  }
}

TEST_CASE("the stress is the derivative of the energy, and the diagonal block that of the force") {
  Mat3<double> H;
  H << 0.3, -0.2, 0.1, 0.4, 0.2, -0.3, -0.1, 0.2, -0.25;
  const double h = 1e-6;
  const Mat3<double> P = svk_stress(H, lambda, mu);
  for (int i = 0; i < 9; ++i) {
    Mat3<double> plus = H, minus = H;
    plus(i) += h;
    minus(i) -= h;
    const double slope =
        (svk_energy_density(plus, lambda, mu) - svk_energy_density(minus, lambda, mu)) / (2 * h);
    CHECK(P(i) == near(slope, 1e-7));
  }
  const Vec3d alpha(0.7, -1.1, 0.4);
  const Mat3<double> block = svk_diagonal_block(H, alpha, lambda, mu);
  for (int d = 0; d < 3; ++d) {
    const Mat3<double> move = Vec3d::Unit(d) * alpha.transpose() * h;  // vertex moves by h along axis d
    const Vec3d slope =
        (svk_stress<double>(H + move, lambda, mu) - svk_stress<double>(H - move, lambda, mu)) * alpha /
        (2 * h);
    CHECK((block.col(d) - slope).norm() < 1e-7 * block.norm());
  }
}
