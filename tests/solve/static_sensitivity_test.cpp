#include "lobe/solve/static_sensitivity.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/scene/material_constants.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double young = 2e4, poisson = 0.4;

Setup with_moduli(Setup setup, double E, double nu) {
  const LamePair lame = lame_from_young(E, nu);
  setup.materials[0].lambda = lame.lambda;
  setup.materials[0].mu = lame.mu;
  return setup;
}

// A bar that is held at one end, moved at the other, and hangs down between.
Setup bar() {
  Setup setup = with_moduli(setup_of(box_mesh({0.08, 0.02, 0.02}, 8, 2, 2)), young, poisson);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
    if (setup.mesh.points(0, v) == 0.08) setup.prescribed.push_back({v, {0.004, 0, 0.006}});
  }
  setup.gravity = {0, 0, -9.81};
  return setup;
}

StaticResult solved(const Setup& setup) {
  StaticResult found = solve_static(setup, {.tolerance = 1e-13});
  REQUIRE_MESSAGE(found.converged, found.reason);
  return found;
}

// Against differences of solutions, whose error is of the second order in the step.
void check_derivative(const Setup& setup, const SetupAt& at, double value) {
  const StaticResult here = solved(setup);
  const StaticDerivative by = StaticSensitivity(setup, here.u).by(at, value, 1e-4 * value);
  const double h = 1e-3 * value;
  const StaticResult more = solved(at(value + h)), less = solved(at(value - h));
  const Mat3X<double> u = (more.u - less.u) / (2 * h), R = (more.reactions - less.reactions) / (2 * h);
  CHECK(u.norm() > 1e-4 * here.u.norm() / value);
  CHECK((by.u - u).norm() < 2e-5 * u.norm());
  CHECK((by.reactions - R).norm() < 2e-5 * R.norm());
}

}  // namespace

TEST_CASE("derivatives of an equilibrium are those of solutions beside it") {
  Setup averaged_bar = averaged(bar()), neo = bar(), hybrid = bar(), partly = bar(), blown = bar();
  neo.materials[0].law = MaterialLaw::neo_hookean;
  for (Index t = 0; t < hybrid.mesh.tet_count(); ++t)
    if (barycentre(hybrid.mesh, t).x() < 0.03) hybrid.region_of[t] = RegionModel::tensor_mass;
  partly.partly_held.push_back({40, 0.6, {0, 0.002, 0}});
  for (const TetFace& face : outer_faces(blown.mesh))
    if (barycentre(blown.mesh, face.tet).z() > 0.015) blown.pressures.push_back({face.tet, face.face, 200});
  for (const Setup& setup :
       {bar(), smoothed(bar()), averaged_bar, smoothed(averaged_bar), neo, hybrid, partly, blown}) {
    check_derivative(
        setup, [&](double E) { return with_moduli(setup, E, poisson); }, young);
    check_derivative(
        setup, [&](double nu) { return with_moduli(setup, young, nu); }, poisson);
    const auto of_density = [&](double density) {
      Setup there = setup;
      there.materials[0].density = density;
      return there;
    };
    check_derivative(setup, of_density, setup.materials[0].density);
  }
}

TEST_CASE("a body that is moved, and not loaded, has the same shape whatever its modulus") {
  Setup moved = bar();
  moved.gravity.setZero();
  const StaticResult here = solved(moved);
  const StaticDerivative by =
      StaticSensitivity(moved, here.u)
          .by([&](double E) { return with_moduli(moved, E, poisson); }, young, 1e-4 * young);
  CHECK(by.u.norm() < 1e-9 * here.u.norm() / young);
  CHECK((young * by.reactions - here.reactions).norm() < 1e-8 * here.reactions.norm());
}

TEST_CASE("a state that is not stable has no derivatives") {
  Setup column = setup_of(box_mesh({0.2, 0.01, 0.01}, 20, 1, 1));
  for (Index v = 0; v < column.mesh.vertex_count(); ++v)
    if (column.mesh.points(0, v) == 0) column.prescribed.push_back({v, Vec3d::Zero()});
  Mat3X<double> crushed = Mat3X<double>::Zero(3, column.mesh.vertex_count());
  crushed.row(0) = -0.6 * column.mesh.points.row(0);
  CHECK_THROWS_AS(StaticSensitivity(column, crushed), InputError);
}
