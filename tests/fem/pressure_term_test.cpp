#include "lobe/fem/pressure_term.h"

#include <doctest/doctest.h>

#include "lobe/fem/svk.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Mat3<double> H{{0.2, 0.3, -0.1}, {0.05, -0.2, 0.2}, {-0.2, 0.1, 0.1}};

}  // namespace

TEST_CASE("the trace of the strain is that of E") {
  CHECK(strain_trace(H) == near(green_strain(H).trace(), 1e-14));
}

TEST_CASE("a pressure λ tr E is what SVK has beyond its shear, in energy and stress") {
  const double lambda = 4e4, mu = 1e4, p = lambda * green_strain(H).trace();
  CHECK(pressure_energy_density(H, p) + svk_energy_density(H, 0.0, mu) ==
        near(svk_energy_density(H, lambda, mu), 1e-14));
  CHECK(pressure_stress(H, p).isApprox(svk_stress(H, lambda, mu) - svk_stress(H, 0.0, mu), 1e-13));
}
