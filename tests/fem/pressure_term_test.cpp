#include "lobe/fem/pressure_term.h"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include "lobe/fem/neo_hookean.h"
#include "lobe/fem/svk.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Mat3<double> H{{0.2, 0.3, -0.1}, {0.05, -0.2, 0.2}, {-0.2, 0.1, 0.1}};

}  // namespace

TEST_CASE("the strain that nodes average is tr E of SVK, and J − 1 of the other laws") {
  CHECK(strain_trace(H) == near(green_strain(H).trace(), 1e-14));
  CHECK(pressure_strain(H, MaterialLaw::svk) == strain_trace(H));
  for (int law = 1; law < law_count; ++law)
    CHECK(pressure_strain(H, MaterialLaw(law)) ==
          near((Mat3<double>::Identity() + H).determinant() - 1, 1e-13));
}

TEST_CASE("a pressure λ tr E is what SVK has beyond its shear, in energy and stress") {
  const double lambda = 4e4, mu = 1e4, p = lambda * green_strain(H).trace();
  CHECK(pressure_energy_density(H, p, MaterialLaw::svk) + svk_energy_density(H, 0.0, mu) ==
        near(svk_energy_density(H, lambda, mu), 1e-14));
  CHECK(pressure_stress(H, p, MaterialLaw::svk)
            .isApprox(svk_stress(H, lambda, mu) - svk_stress(H, 0.0, mu), 1e-13));
}

TEST_CASE("a pressure λ (J − 1) is what a neo-Hookean solid has beyond its shear, in energy and stress") {
  const double lambda = 4e4, mu = 1e4, p = lambda * volume_change(H);
  CHECK(pressure_energy_density(H, p, MaterialLaw::neo_hookean) + neo_hookean_energy_density(H, 0.0, mu) ==
        near(neo_hookean_energy_density(H, lambda, mu), 1e-14));
  CHECK(pressure_stress(H, p, MaterialLaw::neo_hookean)
            .isApprox(neo_hookean_stress(H, lambda, mu) - neo_hookean_stress(H, 0.0, mu), 1e-13));
}

TEST_CASE("the slope of the strain that nodes average is its derivative") {
  const Mat3<double> turn{{0.4, -0.9, 0.3}, {0.7, 0.5, -0.2}, {-0.6, 0.1, 0.8}};
  for (MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
    const double h = 1e-5, by_step = (pressure_strain<double>(H + h * turn, law) -
                                      pressure_strain<double>(H - h * turn, law)) /
                                     (2 * h);
    const Mat3<double> slope = Mat3<double>::Identity() + pressure_slope_less_one(H, law);
    CHECK(slope.cwiseProduct(turn).sum() == near(by_step, 1e-9));
  }
}
