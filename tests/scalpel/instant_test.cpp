// The instant of a cut, with what changes masses; and pre-computed regions.
#include <doctest/doctest.h>

#include "at_once.h"
#include "condense/half_linear.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh cells() { return irregular_box(5, 0.02); }

// Guarded, and so crushed that the guard acts.
Setup guarded() {
  Setup setup = setup_of(cells());
  setup.guard_below = 0.95;
  setup.volume_penalty = 1e5;
  return setup;
}

}  // namespace

TEST_CASE("where tetrahedra are guarded, a cut changes nothing at once") {
  check_that_a_cut_changes_nothing_at_once(guarded());
}

// Selective masses couple vertices that tetrahedra join. So lumped sums stay, and so does the kinetic energy
// of what moves as one; that of other motion changes.
TEST_CASE("with selective masses a cut changes no mass, force, momentum or elastic energy") {
  Setup setup = hybrid_setup(cells());
  setup.selective_mass = 3;
  setup.cut_step = 0;
  for (const bool as_one : {false, true}) {
    World<double> world = moving_world<double>(setup);
    State<double> state = world.state();
    if (as_one) state.v.colwise() = Vec3d(0.1, -0.2, 0.3);
    world.set_state(state);
    const Whole before = whole_of(world);
    cut(world, incisions_of(setup.mesh, 3));
    CHECK(world.elements().topology.tet_copy_count() > 50);
    const Whole after = whole_of(world);
    check_nearly_equal(after.masses, before.masses);
    check_nearly_equal(after.momentum, before.momentum);
    check_nearly_equal(after.angular_momentum, before.angular_momentum);
    check_nearly_equal(after.forces, before.forces);
    CHECK(after.elastic == near(before.elastic, 1e-12));
    CHECK((std::abs(after.kinetic / before.kinetic - 1) < 1e-12) == as_one);
  }
}

TEST_CASE("with selective masses or a guard, a cut body equals one built afresh") {
  Setup setup = hybrid_setup(cells());
  setup.selective_mass = 3;
  check_that_it_equals_one_built_afresh(setup);
  World<double> world = moving_world<double>(setup);
  cut(world, incisions_of(setup.mesh, 3));
  CompactMesh compacted;
  World<double> fresh(world.current_setup(compacted));
  REQUIRE(fresh.elements().topology.vertex_count() == world.elements().topology.vertex_count());
  fresh.set_state(world.state());
  CHECK(world.body().inertia.degree() == 3);
  CHECK(world.energies().kinetic == near(fresh.energies().kinetic, 1e-12));  // with all couplings
  check_that_it_equals_one_built_afresh(guarded());
}

// Mass of the floor moves with its vertex: that, and nothing else, adds momentum and energy. (Pieces that
// come loose would become non-linear, so a hybrid body is cut less.)
TEST_CASE("with the mass floor, momentum and energy grow by what the added mass has") {
  struct Case {
    Setup setup;
    int strokes;
  };
  for (const auto& [setup, strokes] :
       {Case{setup_of(cells()), 12}, Case{hybrid_setup(cells()), 3}, Case{fibrous_setup(cells()), 12}}) {
    REQUIRE(setup.cut_step == 0.75);
    World<double> world = moving_world<double>(setup);
    const Whole before = whole_of(world);
    cut(world, incisions_of(setup.mesh, strokes));
    const Whole after = whole_of(world);
    const Inertia<double>& inertia = world.body().inertia;
    Vec3d momentum = Vec3d::Zero(), angular_momentum = Vec3d::Zero();
    double energy = 0, sum = 0;
    const StateView<double> state = world.state();
    for (Index v = 0; v < world.elements().topology.vertex_count(); ++v) {
      const double added = inertia.mass()[std::size_t(v)] - inertia.weighs(v);
      CHECK(added >= 0);
      const Vec3d p = added * state.v.col(v);
      momentum += p;
      angular_momentum += Vec3d(world.elements().points.col(v) + state.u.col(v)).cross(p);
      energy += added * state.v.col(v).squaredNorm() / 2;
      sum += added;
    }
    CHECK(sum > 0);
    CHECK(sum == near(inertia.mass_of_floor(), 1e-9));
    CHECK(sum < 0.2 * before.masses.sum());
    check_nearly_equal(after.momentum - momentum, before.momentum);
    check_nearly_equal(after.angular_momentum - angular_momentum, before.angular_momentum);
    CHECK(after.kinetic - energy == near(before.kinetic, 1e-12));
    CHECK(after.elastic == near(before.elastic, 1e-12));
    check_nearly_equal(after.forces, before.forces);
  }
}

// The interior of the region follows its interface, which has its mass. What moves as one keeps its momentum.
// If the region is held, the wall bears a part of the mass, which the cut changes.
TEST_CASE("a cut through a pre-computed region keeps the mass and momentum of what moves as one") {
  for (const bool is_held : {false, true}) {
    Setup setup = half_linear(RegionModel::precomputed, 4);
    setup.cut_step = 0;
    if (!is_held) {
      setup.prescribed.clear();
      setup.precomputed_frame = RegionFrame::corotated;
    }
    World<double> world(setup);
    State<double> state = random_state(world, 1e-4);
    state.v.colwise() = Vec3d(0.1, -0.2, 0.3);
    for (const HeldVertices::Held& item : world.held().all()) state.v.col(item.vertex).setZero();
    world.set_state(state);
    const Whole before = whole_of(world);
    cut(world, incisions_of(setup.mesh, 3));
    Index condensed = 0;
    const Topology& topology = world.elements().topology;
    for (Index t = topology.tet_count() - topology.tet_copy_count(); t < topology.tet_count(); ++t)
      condensed += world.elements().is_in(RegionModel::precomputed, t);
    CHECK(condensed > 20);
    const Whole after = whole_of(world);
    const double tolerance = is_held ? 1e-3 : 1e-12;  // of what the wall bears
    CHECK(after.masses.sum() == near(before.masses.sum(), tolerance));
    CHECK((after.momentum - before.momentum).norm() < tolerance * before.momentum.norm());
    CHECK((after.masses.sum() == near(before.masses.sum(), 1e-9)) == !is_held);
  }
}
