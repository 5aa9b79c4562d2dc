#include "lobe/fem/neo_hookean.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fem/moduli.h"
#include "lobe/fem/hooke.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Mat3<double> stretch(double along, double across) {
  return Vec3d(along - 1, across - 1, across - 1).asDiagonal().toDenseMatrix();
}

// What keeps the sides of a bar free of stress: μ t + ((λ + μ)(s t² − 1) − μ) s t = 0 in t², or t = 0.
double free_width(double s) { return std::sqrt(((lambda + 2 * mu) * s - mu) / ((lambda + mu) * s * s)); }

}  // namespace

TEST_CASE("uniaxial strain costs the same as in Hooke's law, however far it is crushed") {
  for (double s : {0.01, 0.5, 0.9, 1.5, 3.0}) {
    const double strain = s - 1;
    CHECK(neo_hookean_stress(stretch(s, 1), lambda, mu)(0, 0) == near((lambda + 2 * mu) * strain, 1e-12));
    CHECK(neo_hookean_energy_density(stretch(s, 1), lambda, mu) ==
          near((lambda + 2 * mu) / 2 * strain * strain, 1e-12));
  }
}

TEST_CASE("a bar whose sides are free has the tension of its closed form") {
  for (double s : {0.6, 0.95, 1.05, 2.0}) {
    const double t = free_width(s), J = s * t * t;
    const Mat3<double> P = neo_hookean_stress(stretch(s, t), lambda, mu);
    CHECK(std::abs(P(1, 1)) < 1e-10 * mu);
    CHECK(P(0, 0) == near(mu * s + ((lambda + mu) * (J - 1) - mu) * t * t, 1e-10));
  }
}

TEST_CASE("simple shear has the shear stress mu times the shear, and none in the volume") {
  for (double g : {0.01, 0.5, 2.0}) {
    Mat3<double> H = Mat3<double>::Zero();
    H(0, 1) = g;
    Mat3<double> expected = Mat3<double>::Zero();  // μ (F − F⁻ᵀ)
    expected(0, 1) = expected(1, 0) = mu * g;
    CHECK((neo_hookean_stress(H, lambda, mu) - expected).norm() < 1e-13 * mu * g);
    CHECK(neo_hookean_energy_density(H, lambda, mu) == near(mu * g * g / 2, 1e-13));
  }
}

TEST_CASE("small strains are those of Hooke's law") {
  const Mat3<double> H = (Mat3<double>() << 0.15, -0.2, 0.1, 0.25, 0.2, -0.15, -0.1, 0.2, 0.1).finished();
  const auto difference = [&](double size) {
    const Mat3<double> hooke = hooke_stress<double>(size * H, lambda, mu);
    return (neo_hookean_stress<double>(size * H, lambda, mu) - hooke).norm() / hooke.norm();
  };
  CHECK(difference(1e-4) / difference(5e-5) == near(2, 1e-2));
  CHECK(difference(1e-9) < 1e-7);
}

TEST_CASE("it resists compression ever more than St Venant-Kirchhoff, which softens") {
  double last = 0;
  for (double s = 0.99; s > -0.5; s -= 0.01) {
    const double tension = neo_hookean_stress(stretch(s, 1), lambda, mu)(0, 0);
    CHECK(tension < last);
    last = tension;
  }
}
