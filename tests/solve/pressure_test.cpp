// Static solutions under pressure, against closed forms.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "lobe/error.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/select.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

void press(Setup& setup, const Selector& where, double pressure) {
  for (const TetFace& face : select_faces(where, setup.mesh, outer_faces(setup.mesh)))
    setup.pressures.push_back({face.tet, face.face, pressure});
}

// Vertices on the planes through the origin slide in them.
void hold_on_planes(Setup& setup) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    PrescribedVertex held{v, Vec3d::Zero(), {}};
    for (int i = 0; i < 3; ++i) held.axes[std::size_t(i)] = std::abs(setup.mesh.points(i, v)) < 1e-12;
    if (held.axes != Axes{}) setup.prescribed.push_back(held);
  }
}

}  // namespace

// F = s I has the Piola stress (3λ + 2μ) s (s² − 1)/2. The pressure on
// the shrunk area, p s², balances it.
TEST_CASE("a block under pressure from all sides shrinks as the law says") {
  Setup setup = setup_of(box_mesh({0.1, 0.08, 0.06}, 3, 3, 3));
  hold_on_planes(setup);
  const Elastic& m = setup.materials[0];
  const double bulk = 3 * m.lambda + 2 * m.mu, s = 0.98, pressure = bulk * (1 - s * s) / (2 * s);
  press(setup, {SelectAll{}}, pressure);
  const StaticResult result = solve_static(setup);
  REQUIRE_MESSAGE(result.converged, result.reason);
  CHECK((result.u - (s - 1) * setup.mesh.points).cwiseAbs().maxCoeff() < 1e-8);
  Setup moving = setup;
  moving.damping = 30;
  moving.load_ramp = 0.1;
  World<double> world(moving);
  for (int i = 0; i < 60; ++i) REQUIRE(world.advance(1.0 / 30).ok);
  CHECK((world.state().u - result.u).norm() < 1e-6 * result.u.norm());
}

// A quarter of a tube of radii 10 and 14 mm that cannot become longer, in small strains:
// u(r_i) = p r_i ((1 − ν − 2ν²) r_i² + (1 + ν) r_o²) / (E (r_o² − r_i²)), Lamé.
TEST_CASE("a tube under inner pressure widens as Lame says, with an error of second order") {
  constexpr double inner = 0.01, outer = 0.014, E = 3e5, nu = 0.3, pressure = 1;
  const double exact = pressure * inner / E *
                       ((1 - nu - 2 * nu * nu) * inner * inner + (1 + nu) * outer * outer) /
                       (outer * outer - inner * inner);
  double errors[2];
  for (int fine = 0; fine < 2; ++fine) {
    const int n = 4 << fine;
    Setup setup = setup_of(box_mesh({1, 1, 1}, n, 2 * n, 1));
    for (auto p : setup.mesh.points.colwise()) {
      const double r = inner + (outer - inner) * p.x(), angle = std::numbers::pi / 2 * p.y();
      p = Vec3d(r * std::cos(angle), r * std::sin(angle), 0.002 * p.z());
      for (double& x : p)
        if (std::abs(x) < 1e-15) x = 0;
    }
    const LamePair lame = lame_from_young(E, nu);
    setup.materials[0].lambda = lame.lambda;
    setup.materials[0].mu = lame.mu;
    hold_on_planes(setup);
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(2, v) > 0.0019)
        setup.prescribed.push_back({v, Vec3d::Zero(), {false, false, true}});
    press(setup, {SelectPatch{{inner / std::numbers::sqrt2, inner / std::numbers::sqrt2, 0.001}, 40}},
          pressure);
    CHECK(setup.pressures.size() == std::size_t(2 * 2 * n));
    const StaticResult result = solve_static(setup);
    REQUIRE_MESSAGE(result.converged, result.reason);
    double sum = 0, count = 0;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
      const Vec3d x = setup.mesh.points.col(v);
      const double r = x.head<2>().norm();
      if (r > inner + 1e-9) continue;
      sum += result.u.col(v).head<2>().dot(x.head<2>()) / r;
      ++count;
    }
    errors[fine] = std::abs(sum / count / exact - 1);
  }
  CHECK(errors[0] < 0.05);
  CHECK(errors[1] < 0.35 * errors[0]);
}

TEST_CASE("pressure is refused where it is not known") {
  Setup setup = setup_of(irregular_box(2));
  hold_on_planes(setup);
  press(setup, {SelectAll{}}, 10);
  CHECK_THROWS_WITH_AS(solve_static_quadratic(setup), doctest::Contains("10-node"), InputError);
  setup.integrator = Integrator::generalised_alpha;
  CHECK_THROWS_AS(World<double>{setup}, InputError);
}
