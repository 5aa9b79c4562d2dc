// Pre-computed regions of edge-smoothed tetrahedra.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "condense/half_linear.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Half of the body is pre-computed; smoothed, and plain in a third of it.
Setup mixed(int n = 4) {
  Setup setup = half_linear(RegionModel::precomputed, n);
  setup.materials[0].element = ElementType::edge_smoothed;
  load(setup);
  return setup;
}

Setup all_smoothed(int n = 4) { return smoothed(mixed(n)); }

// Materials that end at the interface, so that averages end there in a body of one model, too.
Setup expandable_smoothed(int n = 4) {
  Setup setup = all_smoothed(n);
  const auto count = static_cast<std::uint16_t>(setup.materials.size());
  for (std::uint16_t m = 0; m < count; ++m) setup.materials.push_back(setup.materials[m]);
  for (std::size_t t = 0; t < setup.region_of.size(); ++t)
    if (setup.region_of[t] == RegionModel::precomputed) setup.material_of[t] += count;
  setup.guard_below = 0.3;
  setup.expandable = true;
  return setup;
}

Setup with_model(Setup setup, RegionModel model) {
  for (RegionModel& region : setup.region_of)
    if (region == RegionModel::precomputed) region = model;
  return setup;
}

StaticResult solved(const Setup& setup) {
  StaticOptions options;
  options.tolerance = 1e-13;
  StaticResult result = solve_static(setup, options);
  REQUIRE(result.converged);
  return result;
}

double largest_on_free(World<double>& world) {  // on what is free [N]
  double largest = 0;
  for (Index v = 0; v < static_cast<Index>(world.forces().cols()); ++v)
    if (!world.held().holds(v)) largest = std::max(largest, world.forces().col(v).norm());
  return largest;
}

std::vector<Index> shuffled(Index count) {
  std::vector<Index> order(std::size_t(count), 0);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  return order;
}

}  // namespace

TEST_CASE("a condensed region of smoothed tetrahedra is in equilibrium where the static solution is") {
  for (const Setup& setup : {mixed(5), all_smoothed(5)}) {
    const StaticResult exact = solved(setup),
                       tensor_mass = solved(with_model(setup, RegionModel::tensor_mass));
    CHECK((exact.u - tensor_mass.u).norm() < 1e-11 * exact.u.norm());
    World<double> world(setup), uncondensed(with_model(setup, RegionModel::tensor_mass));
    State<double> state = world.state();
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (world.body().inertia.mass()[v] > 0) state.u.col(v) = exact.u.col(v);
    world.set_state(state);
    const double weight = 9.81 * 1000 * 0.05 * 0.05 * 0.05;
    CHECK(largest_on_free(world) < 1e-10 * weight);
    CHECK((world.state().u - exact.u).norm() < 1e-10 * exact.u.norm());
    CHECK(world.energies().elastic_linear + world.energies().elastic_nonlinear == near(exact.energy, 1e-9));
    world.set_state(random_state(world, 1e-3));
    uncondensed.set_state(world.state());
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (!world.body().regions.is_interior(v) && !world.held().holds(v))
        CHECK((world.forces() - uncondensed.forces()).col(v).norm() < 1e-10 * world.forces().norm());
  }
}

TEST_CASE("what holds a condensed region of smoothed tetrahedra bears its loads") {
  Setup setup = all_smoothed(5);
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::precomputed);
  World<double> world(setup);
  for (int i = 0; i < 3; ++i) REQUIRE(world.advance(0.2).ok);
  const StaticResult exact = solved(setup);
  CHECK((world.state().u - exact.u).norm() < 1e-10 * exact.u.norm());
  Vec3d loads = Vec3d::Zero();
  for (const VertexLoad& l : setup.vertex_loads) loads += l.force;
  double mass = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) mass += lumped_mass(world.elements(), v);
  CHECK((world.body().reaction(HeldVertices::boundary) + loads + mass * setup.gravity).norm() <
        1e-9 * mass * setup.gravity.norm());
}

TEST_CASE("cuts and changes of region leave what would be condensed afresh of smoothed tetrahedra") {
  for (RegionFrame frame : {RegionFrame::fixed, RegionFrame::corotated})
    for (Index batch : {1, 9, 60}) {
      if (batch == 1 && frame == RegionFrame::corotated) continue;
      CAPTURE(batch);
      Setup setup = batch == 9 ? mixed() : all_smoothed();
      setup.precomputed_frame = frame;
      World<double> world(setup);
      world.set_state(random_state(world, 1e-3));
      const Index tets = setup.mesh.tet_count();
      const std::vector<Index> order = shuffled(tets);
      world.apply(SetRegion{{order.begin(), order.begin() + 15}, RegionModel::tensor_mass});
      CHECK(compare_with_rebuilt(world).largest() < 1e-9);
      for (Index i = 0; i < tets; i += batch) {
        world.remove_tets({order.begin() + i, order.begin() + std::min(tets, i + batch)});
        CAPTURE(i);
        CHECK(compare_with_rebuilt(world).largest() < 1e-9);
      }
      CHECK(world.forces().norm() == 0);
    }
}

TEST_CASE("smoothed tetrahedra enter and leave the pre-computed region where they are") {
  const Setup setup = all_smoothed();
  World<double> world(setup);
  world.set_state(random_state(world, 1e-4));
  std::vector<Index> inner;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (std::abs(barycentre(setup.mesh, t).x() - 0.02) < 0.008) inner.push_back(t);
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::precomputed, RegionModel::tensor_mass,
                            RegionModel::precomputed}) {
    const Mat3X<double> before = world.state().u;
    world.apply(SetRegion{inner, model});
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (world.body().inertia.mass()[v] > 0)
        CHECK((world.state().u.col(v) - before.col(v)).norm() < 1e-12 * before.norm());
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  }
}

TEST_CASE("an expanded region of smoothed tetrahedra is non-linear of the same element, through cuts") {
  const Setup setup = expandable_smoothed();
  World<double> world(setup), nonlinear(with_model(setup, RegionModel::nonlinear));
  world.apply(Expand{});
  world.set_state(nonlinear.state());
  for (int frame = 0; frame < 8; ++frame) {
    if (frame % 2 == 1) {
      world.remove_tets({20 + 11 * frame});
      nonlinear.remove_tets({20 + 11 * frame});
    }
    REQUIRE(world.advance(0.01).ok);
    REQUIRE(nonlinear.advance(0.01).ok);
    CHECK((world.state().u - nonlinear.state().u).norm() < 1e-9 * nonlinear.state().u.norm());
  }
  CHECK(world.energies().total() == near(nonlinear.energies().total(), 1e-9));
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE(
    "a region of smoothed tetrahedra linearised about an equilibrium is in equilibrium there, and cut") {
  Setup setup = expandable_smoothed();
  const double end = setup.mesh.points.row(0).maxCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > end - 0.004) setup.prescribed.push_back({v, {6e-4, 0.006, 1.8e-3}});
  setup.ramp = 0;
  const StaticResult exact = solved(with_model(setup, RegionModel::nonlinear));
  World<double> world(setup);
  State<double> state = world.state();
  state.u = exact.u;
  world.set_state(state);
  const double at_rest = largest_on_free(world);
  world.apply(Expand{});
  world.set_state(state);
  world.apply(Relinearise{1e-9});
  while (world.body().regions.is_condensing()) REQUIRE(world.advance(1e-9).ok);
  world.set_state(state);
  world.apply(Condense{});
  CHECK(largest_on_free(world) < 1e-8 * at_rest);
  CHECK((world.state().u - exact.u).norm() < 1e-8 * exact.u.norm());
  CHECK(world.energies().elastic_linear + world.energies().elastic_nonlinear == near(exact.energy, 1e-8));
  for (int cut = 0; cut < 10; ++cut) {
    world.remove_tets({17 + 13 * cut, 40 + 13 * cut});
    if (cut == 4) world.apply(SetRegion{{100, 101, 102}, RegionModel::tensor_mass});
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  }
}

TEST_CASE("a checkpoint of cuts and grasps in a region of smoothed tetrahedra goes on with the same bits") {
  Setup setup = all_smoothed(5);
  setup.cauteries.push_back({"bipolar", 0.006, {{0, {0.015, -0.01, 0.05}}, {0.1, {0.03, 0.06, 0.03}}}});
  setup.grasps.push_back({"grasper", {14, 50, 51, 52}, {{0.03, {0, 0, 0}}, {0.1, {0.001, 0, 0}}}, true});
  World<float> first(setup), second(setup), other_threads(setup, 2);
  for (int i = 0; i < 4; ++i) {
    REQUIRE(first.advance(0.02).ok);
    REQUIRE(other_threads.advance(0.02).ok);
  }
  CHECK(same_bits(first, other_threads));
  second.restore(first.save());
  for (int i = 0; i < 4; ++i) {
    first.advance(0.02);
    second.advance(0.02);
    CHECK(same_bits(first, second));
  }
  CHECK(first.journal().edits.size() > 4);
}
