// Yeoh's solid: closed forms of one deformation each, and what no other test of the laws says.
#include "lobe/fem/yeoh.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fem/moduli.h"
#include "lobe/fem/law.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double c2 = -2e3, c3 = 9e3;

Law<double> yeoh(double bulk = lambda + 2 * mu / 3) {
  Law<double> law{};
  law.lambda = bulk - 2 * mu / 3;
  law.mu = mu;
  law.terms = {.solid = MaterialLaw::yeoh};
  law.further = {c2, c3};
  return law;
}
double slope_of(double q) { return mu / 2 + 2 * c2 * q + 3 * c3 * q * q; }

Mat3<double> diagonal(double a, double b, double c) { return Vec3d(a, b, c).asDiagonal(); }

}  // namespace

TEST_CASE("the inverse cube root is that of the standard library") {
  for (double J = 0.2; J < 1000; J *= 1.07) CHECK(inverse_cube_root(J) == near(1 / std::cbrt(J), 2e-15));
  for (float J = 0.2f; J < 1000; J *= 1.07f)
    CHECK(double(inverse_cube_root(J)) == near(1 / std::cbrt(double(J)), 4e-7));
}

TEST_CASE("in simple shear the shear stress is 2 w'(γ²) γ") {
  for (double g : {1e-6, 1e-3, 0.1, 0.5, 1.0, 2.0}) {
    Mat3<double> H = Mat3<double>::Zero();
    H(0, 1) = g;
    const Mat3<double> P = law_stress(yeoh(), H);
    CAPTURE(g);
    CHECK(P(0, 1) == near(2 * slope_of(g * g) * g, 1e-13));
    CHECK(law_energy_density(yeoh(), H) ==
          near(g * g * (mu / 2 + g * g * (c2 + g * g * c3)), g < 1e-2 ? 1e-3 : 1e-12));
  }
}

// Of an incompressible bar P₁₁ = 2 w′ (l − 1/l²); with free sides the pressure is that which makes P₂₂ = 0.
TEST_CASE("a stretched bar tends to the incompressible one as the bulk modulus grows, at first order") {
  for (double l : {0.6, 0.9, 1.2, 1.8}) {
    const auto pull = [&](double bulk) {
      double low = 0.3, high = 3;  // the stretch across: P₂₂ grows with it
      for (int i = 0; i < 200; ++i) {
        const double m = (low + high) / 2;
        (law_stress(yeoh(bulk), diagonal(l - 1, m - 1, m - 1))(1, 1) < 0 ? low : high) = m;
      }
      return law_stress(yeoh(bulk), diagonal(l - 1, low - 1, low - 1))(0, 0);
    };
    const double q = l * l + 2 / l - 3, exact = 2 * slope_of(q) * (l - 1 / (l * l));
    const double error = pull(1e8) / exact - 1, tenth = pull(1e9) / exact - 1;
    CAPTURE(l);
    CHECK(std::abs(error) < 0.005);
    CHECK(error / tenth == near(10, 0.03));
  }
}

TEST_CASE("a change of volume alone meets the bulk modulus alone") {
  for (double s : {0.7, 0.999, 1.1, 2.0}) {
    const double J = s * s * s, K = lambda + 2 * mu / 3;
    const Mat3<double> P = law_stress(yeoh(), diagonal(s - 1, s - 1, s - 1));
    CHECK(P(0, 0) == near(K * (J - 1) * s * s, 1e-12));
    CHECK(std::abs(P(0, 1)) == 0);
  }
}

// As a fraction of strain, what single precision loses: the terms in H are summed up without a 1.
TEST_CASE("in single precision a small strain keeps its digits") {
  Mat3<double> H;
  H << 3, -1, 2, 0.5, -2, 1, 4, 1, 1;
  for (double size : {1e-2, 1e-4, 1e-6}) {
    const Mat3<double> small = size * H, exact = law_stress(yeoh(), small);
    const Mat3<float> single = Yeoh::stress<float>(small.cast<float>(), yeoh().as<float>());
    CHECK((single.cast<double>() - exact).norm() < 3e-6 * exact.norm());
  }
}

TEST_CASE("energy, stress and stiffness are continuous where φ becomes a polynomial") {
  const auto at = [](double J) { return diagonal(J - 1, 0, 0); };
  const double J0 = double(0.2f), h = 1e-9;
  const Vec3d alpha(30, -10, 20);
  const Mat3<double> left = at(J0 - h), right = at(J0 + h);
  CHECK(law_energy_density(yeoh(), left) == near(law_energy_density(yeoh(), right), 1e-7));
  CHECK((law_stress(yeoh(), left) - law_stress(yeoh(), right)).norm() <
        1e-6 * law_stress(yeoh(), left).norm());
  CHECK((law_diagonal_block(yeoh(), left, alpha) - law_diagonal_block(yeoh(), right, alpha)).norm() <
        1e-6 * law_diagonal_block(yeoh(), left, alpha).norm());
}

TEST_CASE("moduli that resist no large stretch are named") {
  Law<double> law = yeoh();
  CHECK(std::string(Yeoh::fault(law)).empty());
  law.further = {-1e3, 0};
  CHECK(std::string(Yeoh::fault(law)).find("yeoh_c2") != std::string::npos);
  law.further = {0, -1};
  CHECK(std::string(Yeoh::fault(law)).find("yeoh_c3") != std::string::npos);
  law.further = {std::nan(""), 0};
  CHECK_FALSE(std::string(Yeoh::fault(law)).empty());
  law.further = {0, 0};
  CHECK(std::string(Yeoh::fault(law)).empty());
}
