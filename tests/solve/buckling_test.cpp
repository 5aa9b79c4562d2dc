// Columns that buckle.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double length = 0.2;  // [m]

// Clamped at z = 0, with a force on its free end [N].
Setup column(const Vec3d& force) {
  Setup setup = setup_of(box_mesh({0.01, 0.012, length}, 2, 2, 30));
  const LamePair lame = lame_from_young(1e5, 0.3);
  setup.materials[0].lambda = lame.lambda;
  setup.materials[0].mu = lame.mu;
  std::vector<Index> end;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(2, v) < 1e-9) setup.prescribed.push_back({v, Vec3d::Zero()});
    if (setup.mesh.points(2, v) > length - 1e-9) end.push_back(v);
  }
  for (const Index v : end) setup.vertex_loads.push_back({v, force / double(end.size())});
  return setup;
}

}  // namespace

// Euler's load is π² EI/(4 L²). EI is that of the mesh: F L³/(3 δ) under a small force across. The state
// at which the tangent is looked at is a linear prediction from rest.
TEST_CASE("a column loses its stability about where Euler says") {
  const StaticResult bent = solve_static(column({1e-6, 0, 0}));
  REQUIRE(bent.converged);
  CHECK(bent.buckling == 0);
  const double stiffness = 1e-6 * std::pow(length, 3) / (3 * bent.u.row(0).maxCoeff());
  const double euler = std::pow(std::numbers::pi / (2 * length), 2) * stiffness;
  const StaticResult half = solve_static(column({0, 0, -0.5 * euler}));
  CHECK(half.converged);
  CHECK(half.buckling == 0);
  const StaticResult crushed = solve_static(column({0, 0, -100 * euler}));
  REQUIRE_FALSE(crushed.converged);
  CHECK(crushed.buckling == near(0.01, 0.08));
  CHECK(crushed.reason.find("% of the load (buckling)") != std::string::npos);
}
