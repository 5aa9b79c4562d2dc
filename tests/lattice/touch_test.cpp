// Forces, probes and obstacles on reduced regions.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "folder.h"
#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A ball that presses the upper face of a held bar, slides along it and leaves.
Setup pressed_bar(RegionModel model = RegionModel::reduced) {
  Setup setup = bar(16, 4, true, model);
  setup.damping = 20;
  setup.guard_below = 0.2;
  const double radius = 0.012, above = 0.04 + radius;
  ProbeSetup probe{"probe", RigidShape::sphere(radius), 0.2, {}};
  probe.path = {{0, {0.1, 0.02, above + 0.02}},
                {0.2, {0.1, 0.02, above - 0.008}},
                {0.5, {0.13, 0.02, above - 0.01}},
                {0.7, {0.13, 0.02, above + 0.03}}};
  setup.probes.push_back(probe);
  return setup;
}

Vec3d force_of_probe(World<double>& world) {
  for (const PlacedTool& placed : placed_tools(world))
    if (placed.name == "probe") return placed.force;
  return Vec3d::Zero();
}

}  // namespace

TEST_CASE("a probe presses a reduced bar as it does a non-linear one") {
  World<double> world(pressed_bar()), exact(pressed_bar(RegionModel::nonlinear));
  double largest = 0, top = 0, force_error = 0, highest_force = 0;
  Index fewest_full = world.elements().topology.tet_count();
  for (int i = 0; i < 50; ++i) {
    REQUIRE(world.advance(0.02).ok);
    REQUIRE(exact.advance(0.02).ok);
    top = std::max(top, exact.state().u.norm());
    largest = std::max(largest, (world.state().u - exact.state().u).norm());
    const Vec3d force = force_of_probe(exact);
    highest_force = std::max(highest_force, force.norm());
    force_error = std::max(force_error, (force_of_probe(world) - force).norm());
    fewest_full = std::min(fewest_full, region_of(world).full_tet_count());
  }
  CHECK(fewest_full < world.elements().topology.tet_count() / 2);
  MESSAGE("largest error " << largest / top << ", of the force " << force_error / highest_force);
  REQUIRE(highest_force > 0.05);
  CHECK(largest < 0.1 * top);
  CHECK(force_error < 0.1 * highest_force);
}

TEST_CASE("forces that are set on vertices of a lattice change its momentum by exactly their impulse") {
  const Setup setup = bar(16, 4, false);
  World<double> world(setup);
  REQUIRE(world.body().regions.reduced().any_embedded());
  const Vec3d force(0.1, -0.2, 0.3);
  Index v = 0;
  while (!world.body().regions.reduced().embeds(v)) ++v;
  world.apply(SetForces{{{v, force}}});
  CHECK_FALSE(world.body().regions.reduced().embeds(v));
  CHECK(world.forces().rowwise().sum().isApprox(force, 1e-12));
  for (int i = 0; i < 10; ++i) {
    const Report report = world.advance(0.01);
    REQUIRE(report.ok);
    CHECK(region_of(world).pressed_unseen(world.body().motion).empty());
    if (i == 0) CHECK(world.body().regions.reduced().any_embedded());  // then it is quick
    // Velocities are half a step older than displacements.
    const double until = world.time() - world.state().velocity_lag;
    CHECK((momentum_of(world).linear - until * force).norm() < 1e-10 * (until * force).norm());
  }
}

TEST_CASE("a spring that is set on a vertex of a lattice stores the energy that the body loses") {
  World<double> world(bar(16, 4));
  const auto end = vertices_near(bar(16, 4).mesh, {0.16, 0.02, 0.02}, 0.012);
  std::vector<Spring> springs;
  for (Index v : end) springs.push_back({v, 20, world.elements().points.col(v) + Vec3d(0, 0, 0.004)});
  world.apply(SetSprings{springs});
  const double start = world.energies().total();
  double smallest = start, highest = start;
  for (int i = 0; i < 60; ++i) {
    REQUIRE(world.advance(0.01).ok);
    smallest = std::min(smallest, world.energies().total());
    highest = std::max(highest, world.energies().total());
  }
  CHECK(start > 0);
  CHECK(highest < 1.05 * start);
  CHECK(smallest > 0.8 * start);
}

TEST_CASE("a reduced bar that a probe presses has the same bits on any threads and from a checkpoint") {
  const Setup setup = pressed_bar();
  World<float> world(setup), three(setup, 3);
  const Folder folder;
  for (int i = 0; i < 45; ++i) {
    for (World<float>* each : {&world, &three}) REQUIRE(each->advance(0.02).ok);
    CHECK(same_bits(world, three));
    if (i % 6 != 5) continue;
    write_checkpoint(folder.path / "state", world.save());
    World<float> restored(setup, 2);
    restored.restore(read_checkpoint<float>(folder.path / "state"));
    CHECK(same_bits(world, restored));
    three = std::move(restored);
  }
}

TEST_CASE("a reduced bar that is restored and edited at once knows what was pressed in the last frame") {
  const Setup setup = pressed_bar();
  World<float> world(setup);
  const std::vector<Index> at_end = tets_near(setup.mesh, {0.02, 0.02, 0.02}, 0.012);
  std::size_t pressed = 0;
  for (int i = 0; i < 25; ++i) {
    REQUIRE(world.advance(0.02).ok);
    if (i < 10) continue;
    World<float> restored(setup);
    restored.restore(world.save());
    for (World<float>* each : {&world, &restored}) each->apply(RemoveTets{{at_end.at(std::size_t(i - 10))}});
    const FullZones::State zones = world.save().nodes.zones, others = restored.save().nodes.zones;
    CHECK(zones.touched == others.touched);
    CHECK(zones.until == others.until);
    pressed = std::max(pressed, zones.touched.size());
    restored.advance(0.004);
    world.advance(0.004);
    CHECK(same_bits(world, restored));
  }
  CHECK(pressed > 4);
}

TEST_CASE("a reduced bar that is swung against an obstacle does not pass through it, and no force is lost") {
  const auto swung = [](RegionModel model) {
    Setup setup = bar(16, 4, true, model);
    setup.damping = 5;
    setup.guard_below = 0.2;
    setup.gravity = {0, 0, -9.81};
    setup.contact.obstacles.push_back(
        {"table", RigidShape::box({0.3, 0.3, 0.02}), {0.15, 0.02, -0.03}, {0, 0, 0, 1}, 0.1});
    return setup;
  };
  World<double> world(swung(RegionModel::reduced)), exact(swung(RegionModel::nonlinear));
  const double table = -0.02;
  double lowest = 0, lowest_exact = 0, largest = 0, top = 0;
  for (int i = 0; i < 60; ++i) {
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    REQUIRE(exact.advance(0.02).ok);
    for (const Condition& condition : report.conditions) CHECK(condition.kind != Condition::Kind::lost_force);
    validate(world);
    const Mat3X<double> x = world.elements().points.view() + world.state().u;
    const Mat3X<double> exact_x = world.elements().points.view() + exact.state().u;
    lowest = std::min(lowest, x.row(2).minCoeff());
    lowest_exact = std::min(lowest_exact, exact_x.row(2).minCoeff());
    top = std::max(top, exact.state().u.norm());
    largest = std::max(largest, (world.state().u - exact.state().u).norm());
  }
  CHECK(lowest < table);  // they touch
  CHECK(table - lowest < 1.1 * (table - lowest_exact));
  MESSAGE("largest error " << largest / top);
  CHECK(largest < 0.1 * top);
}
