// Whole bodies against closed forms: positions are prescribed everywhere, nothing is solved.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "lobe/diagnostics/fields.h"
#include "lobe/fem/svk.h"
#include "lobe/sim/world.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("code_aster SSNV122: stretch 1.1 in plane strain, one side free, gives 26610.3 MPa") {
  const double young = 2e5, poisson = 0.3, stretch = 1.1;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               mu = young / (2 * (1 + poisson));
  // S_yy = λ (E_xx + E_yy) + 2μ E_yy = 0 with E_xx = (s² − 1)/2
  const double Exx = (stretch * stretch - 1) / 2, Eyy = -lambda * Exx / (lambda + 2 * mu);
  const double side = std::sqrt(1 + 2 * Eyy);
  CHECK(side == doctest::Approx(0.953939).epsilon(1e-6));
  const Mat3<double> H = Vec3d(stretch - 1, side - 1, 0).asDiagonal();
  const Mat3<double> P = svk_stress(H, lambda, mu);
  CHECK(std::abs(P(1, 1)) < 1e-9 * young);
  CHECK(P(0, 0) / side == doctest::Approx(26610.307).epsilon(1e-7));  // Cauchy: σ = P Fᵀ / det F
}

TEST_CASE("an infinitesimal rotation, free for the linear model, inflates the body by θ²") {
  const TetMesh mesh = irregular_box();
  World<double> world(setup_of(mesh, RegionModel::tensor_mass));
  for (const auto& [degrees, inflation] :
       {std::pair(15., 0.0685), std::pair(30., 0.2742), std::pair(45., 0.6169)}) {
    const double theta = degrees * std::numbers::pi / 180;
    State<double> state = world.state();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      state.u.col(v) = theta * Vec3d(-mesh.points(1, v), mesh.points(0, v), 0);
    world.set_state(state);
    CHECK(world.forces().norm() < 1e-13);
    const double growth = current_volume(world.elements(), state.u) / total_volume(mesh) - 1;
    CHECK(growth == doctest::Approx(theta * theta).epsilon(1e-10));
    CHECK(growth == doctest::Approx(inflation).epsilon(1e-3));
  }
}
