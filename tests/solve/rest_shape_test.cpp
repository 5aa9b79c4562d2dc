#include "lobe/solve/rest_shape.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar that is held on one side and hangs down under gravity.
Setup hanging_bar(double gravity = 9.81) {
  Setup setup = setup_of(box_mesh({0.1, 0.03, 0.03}, 8, 2, 2));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -gravity};
  return setup;
}

// The same body, brought into its equilibrium.
Setup loaded(Setup setup) {
  const StaticResult found = solve_static(setup);
  REQUIRE(found.converged);
  setup.mesh.points += found.u;
  return setup;
}

double largest(const Mat3X<double>& x) { return x.colwise().norm().maxCoeff(); }

}  // namespace

// The inverse of a computed equilibrium is known exactly.
TEST_CASE("the rest shape of a body in equilibrium is that from which it came") {
  Setup neo = hanging_bar(), smoothed = hanging_bar(), held_away = hanging_bar(), pulled = hanging_bar();
  neo.materials[0].law = MaterialLaw::neo_hookean;
  smoothed.materials[0].element = ElementType::edge_smoothed;
  held_away.gravity.setZero();
  for (PrescribedVertex& held : held_away.prescribed) held.displacement = {0, 0, 0.004};
  held_away.vertex_loads.push_back({held_away.mesh.vertex_count() - 1, {0.02, 0, 0.05}});
  pulled.vertex_loads.push_back({pulled.mesh.vertex_count() - 1, {0.1, 0, 0.1}});
  for (const Setup& rest : {hanging_bar(), neo, smoothed, held_away, pulled}) {
    const Setup image = loaded(rest);
    const double moved = largest(image.mesh.points - rest.mesh.points);
    CHECK(moved > 0.003);
    const RestShape found = find_rest_shape(image, {.tolerance = 1e-10});
    REQUIRE_MESSAGE(found.converged, found.reason);
    CHECK(found.distance <= 1e-10);
    CHECK(largest(found.points - rest.mesh.points) < 1e-7 * moved);
    CHECK(largest(found.points + found.u - image.mesh.points) <= 1e-10);
    CHECK(found.iterations < 30);
  }
}

TEST_CASE("a body without loads is at rest as it is given") {
  const Setup setup = hanging_bar(0);
  const RestShape found = find_rest_shape(setup);
  CHECK(found.converged);
  CHECK(found.iterations == 1);
  CHECK(found.points == setup.mesh.points);
  CHECK(found.u.isZero(0));
}

TEST_CASE("what cannot be found is said, and the best shape is returned") {
  const Setup image = loaded(hanging_bar());
  int told = 0;
  const RestShape early = find_rest_shape(
      image, {.tolerance = 1e-12, .most_iterations = 2, .progress = [&](int, double) { ++told; }});
  CHECK_FALSE(early.converged);
  CHECK(early.reason.find("after 2 static solutions") != std::string::npos);
  CHECK(told == 2);
  CHECK(early.distance < largest(image.mesh.points - hanging_bar().mesh.points));
  Setup crushed = hanging_bar(3e5);
  const RestShape none = find_rest_shape(crushed);
  CHECK_FALSE(none.converged);
  CHECK_FALSE(none.reason.empty());
  CHECK(none.points.allFinite());
  Setup free = hanging_bar();
  free.prescribed.clear();
  CHECK_THROWS_AS(find_rest_shape(free), InputError);
}
