// Many strokes through bodies that move: nothing is lost, and what retraces its path divides no more.
#include <doctest/doctest.h>

#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct Sums {
  double volume = 0, weight = 0;  // [m³], [kg] without the floor's
};

Sums sums_of(const World<double>& world) {
  Sums sums;
  const Topology& topology = world.elements().topology;
  for (Index t = 0; t < topology.tet_count(); ++t) sums.volume += world.elements().volume(t);
  for (Index v = 0; v < topology.vertex_count(); ++v) sums.weight += world.body().inertia.weighs(v);
  return sums;
}

Index most_grains_of_a_tet(const World<double>& world) {
  const Topology& topology = world.elements().topology;
  Index most = 0;
  for (Index t = 0; t < topology.tet_count() - topology.tet_copy_count(); ++t)
    most = std::max(most, world.grains()->divided(t));
  return most;
}

// A bar along x that swings by its weight, held where x is least.
Setup swinging_bar() {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  setup.materials = {{3e5, 7.5e4, 1000}};
  setup.gravity = {0, 0, -9.81};
  setup.damping = 5;
  return setup;
}

constexpr double high = 0.045, low = 0.012;  // the blade goes into the bar, and out again

void check_what_retraced(World<double>& world, const Setup& setup, Index after_first, double most_growth) {
  CHECK(after_first > setup.mesh.tet_count() + 50);
  CHECK(world.grains()->count() <= most_growth * after_first);
  CHECK(world.state().u.row(2).minCoeff() < -0.01);  // it swings by an edge of the mesh
  validate(world);
  check_connections(world);
  const Sums before = sums_of(World<double>(setup)), after = sums_of(world);
  CHECK(after.volume == near(before.volume, 1e-12));
  CHECK(after.weight == near(before.weight, 1e-12));
  CHECK(world.elements().topology.alive_count() == world.elements().topology.tet_count());
  CHECK(most_grains_of_a_tet(world) <= 256);
}

}  // namespace

TEST_CASE("a stroke that retraces its path 50 times in a bar that swings loses nothing") {
  Setup setup = swinging_bar();
  ScalpelSetup blade{"blade", 0.1, {}, {}};
  for (int i = 0; i <= 50; ++i) {
    const double z = i % 2 == 0 ? high : low;
    blade.path.push_back({0.02 + 0.05 * i, {0.063, -0.02, z}});
    blade.heels.push_back({0.063, 0.05, z});
  }
  setup.scalpels = {blade};
  World<double> world(setup);
  Index after_first = 0;
  while (world.time() < 2.6) {
    REQUIRE(world.advance(1.0 / 60).ok);
    if (world.time() < 0.08) after_first = world.grains() ? world.grains()->count() : 0;
  }
  check_what_retraced(world, setup, after_first, 1.05);
}

TEST_CASE("50 strokes on the same path in a bar that swings lose nothing") {
  const Setup setup = swinging_bar();
  World<double> world(setup);
  Index after_first = 0;
  for (int stroke = 0; stroke < 50; ++stroke) {
    const ToolId id = world.tools().next_id();
    world.apply(BringScalpel{"blade", {{0.063, -0.02, high}, {0.063, 0.05, high}}, 0.1});
    world.apply(SwitchTool{id, true});
    world.apply(Lead{id, {Vec3d(0.063, -0.02, (high + low) / 2)}});
    REQUIRE(world.advance(1.0 / 60).ok);
    world.apply(Lead{id, {Vec3d(0.063, -0.02, low)}});
    REQUIRE(world.advance(1.0 / 60).ok);
    world.apply(LetGo{id});
    if (stroke == 0) after_first = world.grains()->count();
  }
  check_what_retraced(world, setup, after_first, 1.25);
}

TEST_CASE("a hundred random strokes through a body that moves keep its volume and its weight") {
  Setup setup = setup_of(irregular_box(3, 0.03));
  setup.gravity.setZero();
  World<double> world(setup);
  State<double> state = world.state();
  state.v = random_displacement<double>(setup.mesh.vertex_count(), 0.05, 8);
  world.set_state(state);
  const Sums before = sums_of(world);
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.01, 0.08);
  double area = 0;
  for (int stroke = 0; stroke < 100; ++stroke) {
    const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                along = n.unitOrthogonal(), edge = 0.1 * n.cross(along),
                middle(uniform(random), uniform(random), uniform(random));
    const auto tip = [&](int k) { return Vec3d(middle + (0.04 * k - 0.12) * along - edge / 2); };
    const ToolId id = world.tools().next_id();
    world.apply(BringScalpel{"blade", {tip(0), tip(0) + edge}, 0.1});
    world.apply(SwitchTool{id, true});
    for (int k = 1; k <= 4; ++k) {
      world.apply(Lead{id, {tip(k)}});
      const Report report = world.advance(2e-4);
      REQUIRE(report.ok);
      CHECK(report.tets_removed == 0);
      area += report.cut_area;
    }
    world.apply(LetGo{id});
  }
  validate(world);
  check_connections(world);
  const Sums after = sums_of(world);
  CHECK(area > 0.05);
  CHECK(world.elements().topology.tet_copy_count() > 1000);
  CHECK(world.body().inertia.mass_of_floor() > 0);
  CHECK(after.volume == near(before.volume, 1e-12));
  CHECK(after.weight == near(before.weight, 1e-12));
}
