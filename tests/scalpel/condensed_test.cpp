// Blades in pre-computed regions, which stay exact.
#include <doctest/doctest.h>

#include "condense/half_linear.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "strokes.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup condensed_block(int n = 4) {
  Setup setup = half_linear(RegionModel::precomputed, n);
  load(setup);
  return setup;
}

Index condensed_copies(const World<double>& world) {
  const Topology& topology = world.elements().topology;
  Index count = 0;
  for (Index t = topology.tet_count() - topology.tet_copy_count(); t < topology.tet_count(); ++t)
    count += world.elements().is_in(RegionModel::precomputed, t);
  return count;
}

void check_that_it_stays_exact(const Setup& setup) {
  World<double> world(setup);
  world.set_state(random_state(world, 1e-4));
  int cuts = 0;
  for (const Incision& incision : incisions_of(setup.mesh, 4)) {
    incise(world, {incision});
    CAPTURE(++cuts);
    const RebuildDifference d = compare_with_rebuilt(world);
    CHECK(d.mass < 1e-9);
    CHECK(d.force < 1e-9);
    CHECK(d.interior < 1e-9);
    CHECK(d.frequency < 1e-9);
    CHECK(d.largest() < 1e-9);
  }
  CHECK(condensed_copies(world) > 30);
  validate(world);
  check_connections(world);
  std::vector<Index> burnt, others;
  for (Index t = 0; t < world.elements().topology.tet_count(); t += 9) burnt.push_back(t);
  world.remove_tets(burnt);
  validate(world);
  check_connections(world);
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  for (Index t = 1; t < world.elements().topology.tet_count(); t += 5)
    if (world.elements().topology.alive(t)) others.push_back(t);
  world.apply(SetRegion{others, RegionModel::nonlinear});
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

// A bar along x, held at both ends, whose left half is pre-computed; a blade comes down into that half.
Setup bar_with_blade(RegionModel left) {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-9 || setup.mesh.points(0, v) > 0.12 - 1e-9)
      setup.prescribed.push_back({v});
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() < 0.06) setup.region_of[std::size_t(t)] = left;
  setup.materials = {{8e4, 2e4, 1000}};
  setup.gravity = {0, 0, -9.81};
  setup.damping = 20;
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.03, {0.033, -0.02, 0.05}}, {0.23, {0.036, -0.02, 0.012}}},
                            {{0.033, 0.05, 0.05}, {0.036, 0.05, 0.012}}});
  return setup;
}

}  // namespace

TEST_CASE("a cut pre-computed region equals one condensed afresh, after every part of a stroke") {
  check_that_it_stays_exact(condensed_block());
}

TEST_CASE("so does one in a frame that turns") {
  Setup setup = condensed_block();
  setup.precomputed_frame = RegionFrame::corotated;
  check_that_it_stays_exact(setup);
}

TEST_CASE("so does one that is non-linear for a while, once it is condensed again") {
  Setup setup = condensed_block();
  setup.expandable = true;
  World<double> world(setup);
  const std::vector<Incision> incisions = incisions_of(setup.mesh, 4);
  REQUIRE(incisions.size() > 6);
  const auto middle = incisions.begin() + 4;
  cut(world, {incisions.begin(), middle});
  world.apply(Expand{});
  cut(world, {middle, incisions.end()});
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  world.apply(Relinearise{1e-9});
  while (world.body().regions.is_condensing()) world.advance(1e-9);
  world.apply(Condense{});
  CHECK(!world.body().regions.is_expanded());
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  CHECK(condensed_copies(world) > 30);
}

TEST_CASE("a region linearised about a state keeps it where vertices are copied") {
  Setup setup = condensed_block();
  setup.expandable = true;
  World<double> world(setup);
  world.apply(Expand{});
  world.set_state(random_state(world, 1e-4));
  world.apply(Relinearise{1e-9});
  while (world.body().regions.is_condensing()) world.advance(1e-9);
  world.apply(Condense{});
  REQUIRE(world.body().regions.linearised_about().size() > 0);
  cut(world, incisions_of(setup.mesh, 3));
  CHECK(condensed_copies(world) > 30);
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE("a bar cut in its pre-computed half comes to rest where the static solver finds it") {
  World<double> world(bar_with_blade(RegionModel::precomputed));
  for (int i = 0; i < 90; ++i) CHECK(world.advance(1.0 / 30).ok);
  CHECK(condensed_copies(world) > 10);
  CHECK(world.elements().topology.pieces().size() == 1);
  CompactMesh c;
  Setup setup = world.current_setup(c);
  for (RegionModel& region : setup.region_of)
    if (region == RegionModel::precomputed) region = RegionModel::tensor_mass;
  const StaticResult solved = solve_static(setup);
  REQUIRE(solved.converged);
  const Mat3X<double> u = world.state().u(Eigen::all, c.vertex_source);
  CHECK((u - solved.u).norm() < 1e-6 * solved.u.norm());
}

TEST_CASE(
    "a region that can be expanded is, before a blade is there, and can be condensed again afterwards") {
  Setup setup = bar_with_blade(RegionModel::precomputed);
  setup.expandable = true;
  World<double> world(setup);
  CHECK(!world.body().regions.is_expanded());
  double area = 0;
  for (int i = 0; i < 9; ++i) {
    area += world.advance(1.0 / 30).cut_area;
    if (area > 0) CHECK(world.body().regions.is_expanded());
  }
  CHECK(area > 0);
  CHECK(condensed_copies(world) > 10);
  validate(world);
  world.apply(Relinearise{1e-9});
  while (world.body().regions.is_condensing()) world.advance(1e-9);
  world.apply(Condense{});
  CHECK(!world.body().regions.is_expanded());
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE("bits are the same on any number of threads and from a checkpoint within a stroke") {
  const Setup setup = bar_with_blade(RegionModel::precomputed);
  const Mat3X<float> one = after_run<float>(setup, 1, 12);
  CHECK(after_run<float>(setup, 2, 12) == one);
  CHECK(after_run<float>(setup, 7, 12) == one);
  World<float> world(setup);
  for (int i = 0; i < 5; ++i) world.advance(1.0 / 30);
  REQUIRE(world.grains());
  World<float> other(setup);
  other.restore(world.save());
  for (int i = 5; i < 12; ++i) other.advance(1.0 / 30);
  CHECK(other.state().u == one);
}

TEST_CASE("what a blade cuts off a pre-computed region becomes non-linear, and falls with all its mass") {
  Setup setup = bar_with_blade(RegionModel::precomputed);
  std::erase_if(setup.prescribed, [&](const PrescribedVertex& prescribed) {
    return setup.mesh.points(0, prescribed.vertex) > 0.06;
  });
  setup.scalpels[0].path[1].position.z() = setup.scalpels[0].heels[1].z() = -0.05;
  World<double> world(setup);
  for (int i = 0; i < 15; ++i) CHECK(world.advance(1.0 / 30).ok);
  validate(world);
  CHECK(world.elements().topology.pieces().size() >= 2);
  double mass = 0, volume = 0, fallen = 0;  // what is condensed without an interface does not move
  for (Index v = 0; v < world.elements().topology.vertex_count(); ++v)
    if (!world.held().holds(v)) mass += world.body().inertia.weighs(v);
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) {
    volume += world.elements().volume(t);
    if (world.elements().is_in(RegionModel::nonlinear, t)) fallen += world.elements().volume(t);
  }
  CHECK(volume == near(total_volume(setup.mesh), 1e-12));
  CHECK(fallen > 0.6 * volume);
  CHECK(mass == near(1000 * fallen, 1e-12));
  const Mat3X<double> u = world.state().u;
  CHECK(u.row(2).minCoeff() < -0.1);
}
