// Precomputed regions that are non-linear for a while, and that are linearised anew.
#include <doctest/doctest.h>

#include <algorithm>

#include "condense/half_linear.h"
#include "folder.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup expandable(int n = 4) {
  Setup setup = half_linear(RegionModel::precomputed, n);
  load(setup);
  setup.expandable = true;
  return setup;
}

Setup all_nonlinear(Setup setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  return setup;
}

template <class Real>
void wait_for_relinearising(World<Real>& world, double moment = 1e-9) {
  world.apply(Relinearise{moment});
  while (world.body().regions.is_condensing()) REQUIRE(world.advance(moment).ok);
}

double largest_force(World<double>& world) {  // on what is free [N]
  const auto forces = world.forces();
  double largest = 0;
  for (Index v = 0; v < static_cast<Index>(forces.cols()); ++v)
    if (!world.held().holds(v)) largest = std::max(largest, forces.col(v).norm());
  return largest;
}

// The middle of the body pulled by a grip that stays, in equilibrium.
struct Pulled {
  Setup setup = expandable();
  StaticResult exact;
  explicit Pulled(double by) {
    const double end = setup.mesh.points.row(0).maxCoeff();
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(0, v) > end - 0.004) setup.prescribed.push_back({v, {0.1 * by, by, 0.3 * by}});
    setup.ramp = 0;
    StaticOptions options;
    options.tolerance = 1e-13;
    exact = solve_static(all_nonlinear(setup), options);
    REQUIRE(exact.converged);
  }
};

}  // namespace

TEST_CASE("an expanded body is the one that is all non-linear, through motion and cuts") {
  const Setup setup = expandable();
  World<double> world(setup), nonlinear(all_nonlinear(setup));
  world.apply(Expand{});
  CHECK(world.body().regions.is_expanded());
  world.set_state(nonlinear.state());  // not in equilibrium with its loads, as the interior was
  for (int frame = 0; frame < 8; ++frame) {
    if (frame % 2 == 1) {
      world.remove_tets({20 + 11 * frame});
      nonlinear.remove_tets({20 + 11 * frame});
    }
    REQUIRE(world.advance(0.01).ok);
    REQUIRE(nonlinear.advance(0.01).ok);
    CHECK((world.state().u - nonlinear.state().u).norm() < 1e-9 * nonlinear.state().u.norm());
  }
  CHECK(world.body().inertia.mass() == nonlinear.body().inertia.mass());
  CHECK(world.energies().total() == near(nonlinear.energies().total(), 1e-9));
  CHECK((world.body().reaction(HeldVertices::boundary) - nonlinear.body().reaction(HeldVertices::boundary))
            .norm() < 1e-6 * nonlinear.body().reaction(HeldVertices::boundary).norm());
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE("condensed again, it is what it was") {
  World<double> world(expandable()), other(expandable());
  const State<double> state = random_state(world, 2e-4);
  world.set_state(state);
  other.set_state(state);
  world.apply(Expand{});
  world.apply(Condense{});
  CHECK(world.body().inertia.mass() == other.body().inertia.mass());
  CHECK(world.forces() == other.forces());
  CHECK((world.state().u - other.state().u).norm() < 1e-9 * other.state().u.norm());
  CHECK(world.time_step_limit() == near(other.time_step_limit(), 1e-12));
}

TEST_CASE("linearised about a non-linear equilibrium, the region is in equilibrium there") {
  const Pulled pulled(0.006);
  World<double> world(pulled.setup);
  State<double> state = world.state();
  state.u = pulled.exact.u;
  world.set_state(state);
  const double at_rest = largest_force(world);
  world.apply(Expand{});
  world.set_state(state);
  wait_for_relinearising(world);
  world.set_state(state);
  world.apply(Condense{});
  CHECK(world.body().regions.linearised_about() == state.u);
  CHECK(largest_force(world) < 1e-8 * at_rest);
  CHECK((world.state().u - pulled.exact.u).norm() < 1e-8 * pulled.exact.u.norm());
  CHECK(world.energies().elastic_linear + world.energies().elastic_nonlinear ==
        near(pulled.exact.energy, 1e-8));
}

TEST_CASE("its error grows with the square of the distance from there") {
  const auto error = [](double further) {
    const Pulled from(0.004), to(0.004 + further);
    World<double> world(to.setup);
    State<double> state = world.state();
    state.u = from.exact.u;
    world.apply(Expand{});
    world.set_state(state);
    wait_for_relinearising(world);
    state.u = to.exact.u;
    world.set_state(state);
    world.apply(Condense{});
    return (world.state().u - to.exact.u).norm();  // of the interior, the interface given
  };
  const double whole = error(0.002), half = error(0.001);
  CAPTURE(whole);
  CAPTURE(half);
  CHECK(whole / half > 3.5);
  CHECK(whole / half < 4.5);
}

TEST_CASE(
    "cuts, grips and changes of region around a renewal leave what would be condensed afresh about the same "
    "state") {
  Setup setup = expandable();
  setup.grasps.push_back({"grasper", {60, 61, 66}, {{0.03, {0, 0, 0}}, {0.2, {0, 0.001, 0.001}}}, true});
  World<double> world(setup);
  REQUIRE(world.advance(0.02).ok);
  world.remove_tets({3});
  world.apply(Relinearise{0.03});
  CHECK(world.body().regions.is_condensing());
  for (int i = 0; i < 12; ++i) {
    CAPTURE(i);
    world.remove_tets({17 + 13 * i, 40 + 13 * i});
    if (i == 4) world.apply(SetRegion{{100, 101, 102}, RegionModel::tensor_mass});
    if (i == 5) world.apply(Expand{});
    if (i == 7) {
      CHECK_FALSE(world.body().regions.can_condense());
      CHECK_THROWS_WITH_AS(world.apply(Condense{}), doctest::Contains("relinearised"), InputError);
      wait_for_relinearising(world);
      world.apply(Condense{});
    }
    REQUIRE(world.advance(0.01).ok);
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  }
  CHECK_FALSE(world.body().regions.is_condensing());
  CHECK(world.body().regions.linearised_about().size() > 0);
}

TEST_CASE("the same bits on two and seven threads, and from a checkpoint file in between") {
  const auto play = [](World<float>& world, int from, int to) {
    for (int i = from; i < to; ++i) {
      if (i == 1) world.apply(Expand{});
      if (i == 2 || i == 6) world.apply(Relinearise{0.025});
      if (i == 6) world.apply(Condense{});
      if (i == 7) world.remove_tets({5 * i, 5 * i + 1});
      REQUIRE(world.advance(0.01).ok);
    }
  };
  World<float> first(expandable(), 1), second(expandable(), 2);
  play(first, 0, 10);
  play(second, 0, 10);
  CHECK(first.state().u == second.state().u);
  for (int at : {3, 5, 8}) {
    CAPTURE(at);
    const Folder folder;
    World<float> saved(expandable()), third(expandable(), 7);
    play(saved, 0, at);
    write_checkpoint(folder.path / "state", saved.save());
    third.restore(read_checkpoint<float>(folder.path / "state"));
    CHECK(third.body().regions.is_expanded() == saved.body().regions.is_expanded());
    play(third, at, 10);
    CHECK(first.state().u == third.state().u);
    CHECK(first.state().v == third.state().v);
  }
}

TEST_CASE("what cannot be expanded or renewed is refused by name") {
  World<double> plain(half_linear(RegionModel::precomputed));
  CHECK_THROWS_WITH_AS(plain.apply(Expand{}), doctest::Contains("expanded"), InputError);
  CHECK_THROWS_WITH_AS(plain.apply(Relinearise{0}), doctest::Contains("delay"), InputError);
  CHECK_THROWS_WITH_AS(World<double>{averaged(expandable())}, doctest::Contains("nodal_pressure"),
                       InputError);
  Setup turning = expandable();
  turning.precomputed_frame = RegionFrame::corotated;
  CHECK_THROWS_WITH_AS(World<double>{turning}, doctest::Contains("frame"), InputError);
}
