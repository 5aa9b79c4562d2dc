#include "lobe/fem/transverse_isotropy.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "lobe/fem/elements.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

using Voigt = Eigen::Matrix<double, 6, 6>;

constexpr TransverseConstants muscle{9e4, 3e4, 0.4, 0.35, 2e4};

// Stiffness of a fibre along x in Voigt's order xx, yy, zz, yz, xz, xy, as the inverse of the compliance.
Voigt voigt_stiffness(const TransverseConstants& c) {
  Voigt S = Voigt::Zero();
  S(0, 0) = 1 / c.young_along;
  S(1, 1) = S(2, 2) = 1 / c.young_across;
  S(0, 1) = S(1, 0) = S(0, 2) = S(2, 0) = -c.poisson_along / c.young_along;
  S(1, 2) = S(2, 1) = -c.poisson_across / c.young_across;
  S(3, 3) = 2 * (1 + c.poisson_across) / c.young_across;
  S(4, 4) = S(5, 5) = 1 / c.shear_along;
  return S.inverse();
}

Eigen::Matrix<double, 6, 1> voigt_strain(const Mat3<double>& e) {
  return {e(0, 0), e(1, 1), e(2, 2), 2 * e(1, 2), 2 * e(0, 2), 2 * e(0, 1)};
}
Eigen::Matrix<double, 6, 1> voigt_stress(const Mat3<double>& s) {
  return {s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(0, 2), s(0, 1)};
}

Elastic elastic_of(const TransverseConstants& constants) {
  Elastic elastic;
  set_transverse(constants, elastic);
  return elastic;
}

Law<double> along(const TransverseConstants& constants, const Vec3d& a, bool linear = true) {
  Law<double> law = linear ? linear_law(elastic_of(constants)) : nonlinear_law(elastic_of(constants), 0, 0);
  law.direction = a;
  return law;
}

const Mat3<double> asymmetric_gradient =
    (Mat3<double>() << 0.15, -0.2, 0.1, 0.25, 0.2, -0.15, -0.1, 0.2, 0.1).finished();

}  // namespace

TEST_CASE("stress and energy of a fibre along x are those of the stiffness in Voigt's notation") {
  const Law<double> law = along(muscle, Vec3d::UnitX());
  const Mat3<double> strain = (asymmetric_gradient + asymmetric_gradient.transpose()) / 2;
  const auto expected = (voigt_stiffness(muscle) * voigt_strain(strain)).eval();
  CHECK((voigt_stress(linear_stress(law, asymmetric_gradient)) - expected).norm() < 1e-13 * expected.norm());
  CHECK(linear_energy_density(law, asymmetric_gradient) ==
        near(expected.dot(voigt_strain(strain)) / 2, 1e-13));
}

TEST_CASE("simple shear in the three planes has the stress of the stiffness in Voigt's notation") {
  const Law<double> law = along(muscle, Vec3d::UnitX(), false);
  for (double g : {1e-3, 0.4, 1.5})
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        if (i == j) continue;
        Mat3<double> F = Mat3<double>::Identity();
        F(i, j) = g;
        const Mat3<double> E = (F.transpose() * F - Mat3<double>::Identity()) / 2;
        const auto s = (voigt_stiffness(muscle) * voigt_strain(E)).eval();
        const Mat3<double> S{{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
        const Mat3<double> P = law_stress<double>(law, F - Mat3<double>::Identity());
        CHECK((P - F * S).norm() < 1e-12 * P.norm());
      }
}

TEST_CASE("any other direction is that tensor, rotated") {
  const Mat3<double> Q = Eigen::AngleAxisd(1.1, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Mat3<double> stress = linear_stress(along(muscle, Vec3d::UnitX()), asymmetric_gradient);
  const Mat3<double> turned =
      linear_stress<double>(along(muscle, Q.col(0)), Q * asymmetric_gradient * Q.transpose());
  CHECK((turned - Q * stress * Q.transpose()).norm() < 1e-13 * stress.norm());
}

TEST_CASE("the linear block is the second derivative of the linear energy") {
  const Law<double> law = along(muscle, Vec3d(1, 2, -0.5).normalized());
  const Vec3d a(0.3, -0.8, 0.4), b(-0.5, 0.2, 0.9), v(1, 0.4, -0.7), w(0.2, -1, 0.6);
  const Mat3<double> A = v * a.transpose(), B = w * b.transpose();
  const double mixed = linear_energy_density<double>(law, A + B) - linear_energy_density(law, A) -
                       linear_energy_density(law, B);
  CHECK(v.dot(linear_block(law, a, b) * w) == near(mixed, 1e-12));
}

TEST_CASE("the non-linear law has the same small strains") {
  const Law<double> linear = along(muscle, Vec3d(1, 2, -0.5).normalized()),
                    law = along(muscle, linear.direction, false);
  const auto difference = [&](double size) {
    const Mat3<double> H = size * asymmetric_gradient;
    return (law_stress(law, H) - linear_stress(linear, H)).norm() / linear_stress(linear, H).norm();
  };
  CHECK(difference(1e-4) / difference(5e-5) == near(2, 1e-2));  // of first order in the strain
  CHECK(difference(1e-6) < 1e-5);
}

TEST_CASE("constants and moduli are each other's inverse") {
  const TransverseConstants back = transverse_constants(elastic_of(muscle));
  CHECK(back.young_along == near(muscle.young_along, 1e-13));
  CHECK(back.young_across == near(muscle.young_across, 1e-13));
  CHECK(back.poisson_along == near(muscle.poisson_along, 1e-13));
  CHECK(back.poisson_across == near(muscle.poisson_across, 1e-13));
  CHECK(back.shear_along == near(muscle.shear_along, 1e-13));
}

TEST_CASE("equal constants are an isotropic solid to rounding") {
  const Elastic e = elastic_of({3e4, 3e4, 0.3, 0.3, 3e4 / 2.6});
  CHECK(e.lambda == near(3e4 * 0.3 / (1.3 * 0.4), 1e-14));
  CHECK(e.mu == near(3e4 / 2.6, 1e-14));
  for (double modulus : {e.fibre.coupling, e.fibre.shear, e.fibre.stretch}) CHECK(std::abs(modulus) < 1e-10);
}

TEST_CASE("positive definiteness is that of the tensor, on both sides of every bound") {
  const auto is_definite = [](const TransverseConstants& c) {
    return symmetric_eigenvalues<Eigen::MatrixXd>(voigt_stiffness(c))[0] > 0;
  };
  const double bound = std::sqrt((1 - 0.35) * 3 / 2);
  for (double share : {-1.01, -0.99, 0.99, 1.01}) {
    TransverseConstants c = muscle;
    c.poisson_along = share * bound;
    CHECK(is_definite(c) == (std::abs(share) < 1));
    CHECK(is_positive_definite(elastic_of(c)) == is_definite(c));
    CHECK(transverse_faults(c, "").empty() == is_definite(c));
  }
  for (double across : {-1.01, -0.99, 0.65, 0.9}) {
    TransverseConstants c = muscle;
    c.poisson_across = across;
    CHECK(is_positive_definite(elastic_of(c)) == is_definite(c));
    CHECK(transverse_faults(c, "").empty() == is_definite(c));
  }
}

TEST_CASE("a constant out of its bounds is named with its bound") {
  const auto fault = [](TransverseConstants c) { return transverse_faults(c, "/materials/0").at(0); };
  TransverseConstants c = muscle;
  c.poisson_along = 1.2;
  CHECK(fault(c).place == "/materials/0/poisson_ratio_along");
  CHECK(fault(c).message.find("1.2, must be within ±0.98") == 0);
  c = muscle;
  c.young_along = std::nan("");
  CHECK(fault(c).place == "/materials/0/young_modulus_along");
  c = muscle;
  c.poisson_across = 1;
  CHECK(fault(c).message == "1, must be within (-1, 1)");
}
