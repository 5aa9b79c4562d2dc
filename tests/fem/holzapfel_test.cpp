// Holzapfel, Gasser and Ogden's solid: closed forms of one deformation each.
#include "lobe/fem/holzapfel.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "fem/moduli.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_fault.h"
#include "lobe/fem/law_of.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double k1 = 2e4, k2 = 3, theta = 35 * std::numbers::pi / 180;

Elastic material(double stiffening = k2, double angle = theta) {
  Elastic elastic{lambda, mu, 1000, 0, MaterialLaw::holzapfel};
  elastic.further = {k1, stiffening};
  elastic.fibre_angle = angle;
  elastic.fibre_plane = {0.4, 2, 0};
  return elastic;
}
// The families lie in the plane of the first two axes, on both sides of the first.
Law<double> holzapfel(double stiffening = k2, double angle = theta) {
  Law<double> law = nonlinear_law(material(stiffening, angle), 0, 0);
  law.direction = Vec3d(1, 0, 0);
  return law;
}
Law<double> ground() {
  Law<double> law = holzapfel();
  law.terms.solid = MaterialLaw::yeoh;
  law.further = {0, 0};
  return law;
}
Mat3<double> holzapfel_stretched(double a, double b, double c) {
  return Vec3d(a - 1, b - 1, c - 1).asDiagonal();
}
double fibre_slope_of(double E, double stiffening = k2) {
  return E > 0 ? k1 * E * std::exp(stiffening * E * E) : 0;
}

}  // namespace

TEST_CASE("the exponential is that of the standard library") {
  for (double x = 1e-12; x <= 16; x *= 1.3) {
    CHECK(exponential_less_one(x) == near(std::expm1(x), x < 1 ? 4e-15 : 3e-14));
    CHECK(double(exponential_less_one(float(x))) == near(std::expm1(double(float(x))), x < 1 ? 1e-6 : 1e-5));
  }
  CHECK(exponential_less_one(0.0) == 0);
}

TEST_CASE("stretched along both axes of their plane, fibres add 2w' cos² and 2w' sin² of both families") {
  for (double angle : {0.0, theta, std::numbers::pi / 4, std::numbers::pi / 2})
    for (const auto& [a, b] : {std::pair(1.1, 1.05), std::pair(1.3, 0.95), std::pair(0.95, 1.4)}) {
      const Mat3<double> H = holzapfel_stretched(a, b, 1 / (a * b));
      const double c = std::cos(angle), s = std::sin(angle), E = a * a * c * c + b * b * s * s - 1;
      const Mat3<double> fibres = law_stress(holzapfel(k2, angle), H) - law_stress(ground(), H),
                         exact = 4 * fibre_slope_of(E) *
                                 Vec3d(c * c * a, s * s * b, 0).asDiagonal().toDenseMatrix();
      CAPTURE(angle);
      CAPTURE(a);
      CHECK((fibres - exact).norm() < 1e-12 * (exact.norm() + law_stress(ground(), H).norm()));
      const double W = E > 0 ? k1 / k2 * std::expm1(k2 * E * E) : 0,
                   of_ground = law_energy_density(ground(), H);
      CHECK(law_energy_density(holzapfel(k2, angle), H) == near(of_ground + W, 1e-12));
    }
}

TEST_CASE("sheared in their plane, one family is stretched and the other is slack") {
  for (double g : {0.05, 0.2, 0.6}) {
    Mat3<double> H = Mat3<double>::Zero();
    H(0, 1) = g;
    const double angle = 50 * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const Vec3d Fa(c + g * s, s, 0), a(c, s, 0);
    const double E = 2 * g * c * s + g * g * s * s, other = -2 * g * c * s + g * g * s * s;
    REQUIRE(other < 0);
    const Mat3<double> fibres = law_stress(holzapfel(k2, angle), H) - law_stress(ground(), H),
                       exact = 2 * fibre_slope_of(E) * Fa * a.transpose();
    CHECK((fibres - exact).norm() < 1e-11 * exact.norm());
  }
}

TEST_CASE("fibres resist no compression") {
  for (double s : {0.5, 0.8, 0.99}) {
    const Mat3<double> H = holzapfel_stretched(s, s, 1 / (s * s));
    CHECK((law_stress(holzapfel(), H) - law_stress(ground(), H)).norm() <
          1e-14 * law_stress(ground(), H).norm());
    CHECK(law_energy_density(holzapfel(), H) == near(law_energy_density(ground(), H), 1e-13));
  }
}

TEST_CASE("without k2 fibres are springs, and k2 tends to that") {
  const Mat3<double> H = holzapfel_stretched(1.3, 1, 1 / 1.3);
  const double E = 1.3 * 1.3 * std::cos(theta) * std::cos(theta) + std::sin(theta) * std::sin(theta) - 1;
  const Mat3<double> springs = law_stress(holzapfel(0), H);
  CHECK(springs(0, 0) - law_stress(ground(), H)(0, 0) ==
        near(4 * k1 * E * std::cos(theta) * std::cos(theta) * 1.3, 1e-12));
  CHECK((law_stress(holzapfel(1e-9), H) - springs).norm() < 1e-8 * springs.norm());
  CHECK(law_energy_density(holzapfel(0), H) - law_energy_density(ground(), H) == near(k1 * E * E, 1e-11));
}

TEST_CASE("far stretched, fibres go on by a polynomial, without a jump up to the second derivative") {
  const auto at = [](double E) { return holzapfel_stretched(std::sqrt(1 + E), 1, 1); };
  const Law<double> law = holzapfel(k2, 0);
  const double most = 4 / std::sqrt(k2), h = 1e-9;
  const Vec3d alpha(30, -10, 20);
  CHECK(law_energy_density(law, at(most - h)) == near(law_energy_density(law, at(most + h)), 1e-6));
  CHECK((law_stress(law, at(most - h)) - law_stress(law, at(most + h))).norm() <
        1e-6 * law_stress(law, at(most)).norm());
  CHECK((law_diagonal_block(law, at(most - h), alpha) - law_diagonal_block(law, at(most + h), alpha)).norm() <
        1e-6 * law_diagonal_block(law, at(most), alpha).norm());
  CHECK(law_stress(law, at(1000)).allFinite());
  CHECK(Holzapfel::stress<float>(at(1000).cast<float>(), law.as<float>()).allFinite());
}

TEST_CASE("in single precision a small strain of a solid with fibres keeps its digits") {
  Mat3<double> H;
  H << 3, -1, 2, 0.5, -2, 1, 4, 1, 1;
  for (double size : {1e-2, 1e-4, 1e-6}) {
    const Mat3<double> small = size * H, exact = law_stress(holzapfel(), small);
    const Mat3<float> single = Holzapfel::stress<float>(small.cast<float>(), holzapfel().as<float>());
    CHECK((single.cast<double>() - exact).norm() < 3e-6 * exact.norm());
  }
}

TEST_CASE("constants that make no fibres are named") {
  const auto fault = [](auto change) {
    Elastic elastic = material();
    change(elastic);
    return law_fault(elastic);
  };
  CHECK(fault([](Elastic&) {}).empty());
  CHECK(fault([](Elastic& e) { e.further[0] = 0; }).find("holzapfel_k1") == 0);
  CHECK(fault([](Elastic& e) { e.further[1] = -1; }).find("holzapfel_k2") == 0);
  CHECK(fault([](Elastic& e) { e.fibre_angle = 2; }).find("holzapfel_angle") == 0);
  CHECK(fault([](Elastic& e) { e.fibre_plane = {}; }).find("holzapfel_plane") == 0);
  CHECK(fault([](Elastic& e) {
          e.fibre_plane = {};
          e.fibre_angle = 0;
        }).empty());
}
