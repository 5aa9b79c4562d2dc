// Mooney and Rivlin's solid: closed forms of one deformation each.
#include "lobe/fem/mooney_rivlin.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fem/moduli.h"
#include "lobe/fem/law.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double c01 = 0.35 * mu, c10 = mu / 2 - c01;

Law<double> mooney(double bulk = lambda + 2 * mu / 3) {
  Law<double> law{};
  law.lambda = bulk - 2 * mu / 3;
  law.mu = mu;
  law.terms = {.solid = MaterialLaw::mooney_rivlin};
  law.further = {c01, 0};
  return law;
}
Mat3<double> stretched(double a, double b, double c) { return Vec3d(a - 1, b - 1, c - 1).asDiagonal(); }

// P₁₁ of a bar that is stretched by l along 1 and, if it is a sheet, along 2, with free sides.
double pull(const Law<double>& law, double l, bool is_sheet) {
  const auto at = [&](double m) { return law_stress(law, stretched(l, is_sheet ? l : m, m)); };
  double low = 0.2, high = 4;
  for (int i = 0; i < 200; ++i) {
    const double m = (low + high) / 2;
    (at(m)(2, 2) < 0 ? low : high) = m;
  }
  return at(low)(0, 0);
}

}  // namespace

TEST_CASE("in simple shear Mooney and Rivlin's shear stress is μ γ, and the normal ones tell c01") {
  for (double g : {1e-6, 1e-3, 0.1, 0.5, 1.0, 2.0}) {
    Mat3<double> H = Mat3<double>::Zero();
    H(0, 1) = g;
    const Mat3<double> P = law_stress(mooney(), H), sigma = P * (Mat3<double>::Identity() + H).transpose();
    CAPTURE(g);
    CHECK(sigma(0, 1) == near(mu * g, 1e-13));
    CHECK(sigma(0, 0) - sigma(2, 2) == near(2 * c10 * g * g, g < 1e-2 ? 1e-3 : 1e-12));
    CHECK(sigma(1, 1) - sigma(2, 2) == near(-2 * c01 * g * g, g < 1e-2 ? 1e-3 : 1e-12));
    CHECK(law_energy_density(mooney(), H) == near(mu * g * g / 2, g < 1e-2 ? 1e-3 : 1e-12));
  }
}

TEST_CASE("a bar and a sheet tend to the incompressible ones as the bulk modulus grows, at first order") {
  for (bool is_sheet : {false, true})
    for (double l : {0.6, 0.9, 1.2, 1.8}) {
      const double bar = 2 * (c10 + c01 / l) * (l - 1 / (l * l)),
                   sheet = 2 * (c10 + c01 * l * l) * (l - std::pow(l, -5)), exact = is_sheet ? sheet : bar;
      const double error = pull(mooney(1e8), l, is_sheet) / exact - 1,
                   tenth = pull(mooney(1e9), l, is_sheet) / exact - 1;
      CAPTURE(l);
      CHECK(std::abs(error) < 0.01);
      CHECK(error / tenth == near(10, 0.03));
    }
}

TEST_CASE("a change of volume alone meets Mooney and Rivlin's bulk modulus alone") {
  for (double s : {0.7, 0.999, 1.1, 2.0}) {
    const double J = s * s * s, K = lambda + 2 * mu / 3;
    CHECK(law_stress(mooney(), stretched(s, s, s))(0, 0) == near(K * (J - 1) * s * s, 1e-12));
  }
}

TEST_CASE("in single precision a small strain of Mooney and Rivlin's solid keeps its digits") {
  Mat3<double> H;
  H << 3, -1, 2, 0.5, -2, 1, 4, 1, 1;
  for (double size : {1e-2, 1e-4, 1e-6}) {
    const Mat3<double> small = size * H, exact = law_stress(mooney(), small);
    const Mat3<float> single = MooneyRivlin::stress<float>(small.cast<float>(), mooney().as<float>());
    CHECK((single.cast<double>() - exact).norm() < 3e-6 * exact.norm());
  }
}

TEST_CASE("a c01 that leaves a negative modulus is named") {
  Law<double> law = mooney();
  CHECK(std::string(MooneyRivlin::fault(law)).empty());
  for (double bad : {-1.0, 0.51 * mu, std::nan("")}) {
    law.further[0] = bad;
    CHECK(std::string(MooneyRivlin::fault(law)).find("mooney_c01") != std::string::npos);
  }
}
