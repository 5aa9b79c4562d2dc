#include <doctest/doctest.h>

#include <string>

#include "lobe/solve/static_solver.h"
#include "lobe_cholmod/cholmod_factor.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup beam() {
  Setup setup = hybrid_setup(box_mesh({0.06, 0.02, 0.02}, 12, 4, 4));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -20};
  return setup;
}

}  // namespace

TEST_CASE("CHOLMOD finds the equilibrium that Eigen finds") {
  StaticOptions options;
  const StaticResult reference = solve_static(beam(), options);
  options.factor = make_cholmod;
  const StaticResult result = solve_static(beam(), options);
  REQUIRE(result.converged);
  CHECK(result.factor != reference.factor);
  CHECK(result.factor_nonzeros > reference.unknowns);
  CHECK((result.u - reference.u).norm() < 1e-9 * reference.u.norm());
}

TEST_CASE(
    "a tangent that is not positive definite is damped, too, and nodal pressure goes to the other solver") {
  StaticOptions options;
  options.factor = make_cholmod;
  Setup setup = beam();
  for (Elastic& elastic : setup.materials) elastic.nodal_pressure = 1;
  const StaticResult result = solve_static(setup, options);
  CHECK(result.converged);
  CHECK(result.factor.find("Eigen") == 0);

  const auto factor = make_cholmod();
  Eigen::SparseMatrix<double> indefinite(2, 2);
  indefinite.insert(0, 0) = 1;
  indefinite.insert(1, 0) = 2;
  indefinite.insert(1, 1) = 1;
  indefinite.makeCompressed();
  factor->analyse(indefinite);
  CHECK(!factor->factorise(indefinite));
}
