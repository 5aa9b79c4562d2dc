#include "lobe/forces/applied_forces.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "condense/half_linear.h"
#include "lobe/error.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 0.02;  // [s]

std::vector<VertexLoad> forces_on(const Setup& setup) {
  std::vector<VertexLoad> forces;
  for (Index v = 0; v < setup.mesh.vertex_count(); v += 7) forces.push_back({v, {0.002, 0.001, -0.003}});
  return forces;
}

// Every vertex of a free body on a spring of its own, of which all have the same frequency.
std::vector<Spring> springs_to_rest(World<double>& world, double omega) {
  std::vector<Spring> springs;
  for (Index v = 0; v < static_cast<Index>(world.body().inertia.mass().size()); ++v)
    springs.push_back(
        {v, world.body().inertia.mass()[std::size_t(v)] * omega * omega, world.elements().points.col(v)});
  return springs;
}

}  // namespace

TEST_CASE("forces that are set are the dead loads of a setup") {
  Setup setup = half_linear(RegionModel::tensor_mass);
  World<double> applied(setup);
  applied.apply(SetForces{forces_on(setup)});
  setup.vertex_loads = forces_on(setup);
  World<double> loaded(setup);
  for (int i = 0; i < 20; ++i) {
    applied.advance(frame);
    loaded.advance(frame);
  }
  const Mat3X<double> u = loaded.state().u;
  CHECK(u.norm() > 1e-3);
  CHECK((applied.state().u - u).norm() < 1e-10 * u.norm());
  CHECK(applied.energies().applied == near(loaded.energies().loads, 1e-9));
}

TEST_CASE("a body on springs swings as one mass on one spring, with the energy of the scheme kept") {
  World<double> world(setup_of(irregular_box()));
  const double omega = 40, amplitude = 0.002;
  world.apply(SetSprings{springs_to_rest(world, omega)});
  State<double> state = world.state();
  state.u.row(2).setConstant(amplitude);
  world.set_state(state);
  const double mass =
      std::accumulate(world.body().inertia.mass().begin(), world.body().inertia.mass().end(), 0.0);
  CHECK(world.energies().applied == near(mass * omega * omega * amplitude * amplitude / 2, 1e-9));
  const double energy = world.energies().total(), dt = 1e-4;
  for (int i = 0; i < 1000; ++i) world.step(dt);
  // Central differences swing at 2/dt asin(ω dt/2): off by (ω dt)²/24 of the frequency.
  const double expected = amplitude * std::cos(2 / dt * std::asin(omega * dt / 2) * world.time());
  const auto u = world.state().u;
  for (Index v = 0; v < static_cast<Index>(u.cols()); ++v) CHECK(std::abs(u(2, v) - expected) < 1e-9);
  CHECK(world.energies().total() == near(energy, 0.01));
}

TEST_CASE("the step limit knows the stiffness of springs") {
  World<double> world(setup_of(irregular_box()));
  const double alone = world.time_step_limit(), omega = 20 / alone;
  world.apply(SetSprings{springs_to_rest(world, omega)});
  const double limit = world.time_step_limit();
  const double exact = 2 / std::hypot(omega, 2 / alone);  // the squares of all frequencies are higher by ω²
  CHECK(limit < 1.001 * exact);
  CHECK(limit > 0.9 * exact);
  State<double> state = world.state();
  state.v.setRandom();
  state.v *= 1e-3;
  world.set_state(state);
  for (int i = 0; i < 3000; ++i) world.step(0.97 * limit);
  CHECK(world.state().u.cwiseAbs().maxCoeff() < 1e-4);
  world.apply(SetSprings{});
  CHECK(world.time_step_limit() == near(alone, 0.02));
}

TEST_CASE("the point of a spring that is moved pulls, and is there at the end of the frame") {
  Setup setup = setup_of(irregular_box());
  setup.damping = 400;
  World<double> world(setup);
  world.apply(SetSprings{springs_to_rest(world, 100)});
  Mat3X<double> points = setup.mesh.points;
  points.row(0).array() += 0.01;
  world.apply(MoveSprings{points});
  for (int i = 0; i < 100; ++i) world.advance(frame);
  CHECK((world.state().u.colwise() - Vec3d(0.01, 0, 0)).norm() < 1e-9);
  CHECK(world.energies().applied < 1e-15);
}

TEST_CASE("what sleeps wakes where forces are set and where springs move") {
  Setup setup = half_linear(RegionModel::nonlinear);
  setup.damping = 20;
  setup.sleep = 1e-5;
  const Index pulled = setup.mesh.vertex_count() - 1;
  for (const bool by_spring : {false, true}) {
    World<double> world(setup);
    if (by_spring) world.apply(SetSprings{{{pulled, 1.0, setup.mesh.points.col(pulled)}}});
    for (int i = 0; i < 20; ++i) world.advance(frame);
    REQUIRE(world.body().sleep.count() == setup.mesh.vertex_count());
    const Vec3d point = setup.mesh.points.col(pulled) + Vec3d(0.02, 0, 0);
    if (by_spring)
      world.apply(MoveSprings{Mat3X<double>(point)});
    else
      world.apply(SetForces{{{pulled, {0.02, 0, 0}}}});
    world.advance(frame);
    CHECK(world.body().sleep.count() < setup.mesh.vertex_count());
    CHECK(world.state().u(0, pulled) > 1e-5);
  }
}

TEST_CASE("forces and springs are recorded, and are part of a checkpoint, across cuts") {
  Setup setup = half_linear(RegionModel::tensor_mass);
  setup.damping = 5;
  World<float> world(setup), restored(setup, 2);
  CommandRecorder<float> recorded(world);
  const Index far = setup.mesh.vertex_count() - 1;
  recorded.apply(SetForces{forces_on(setup)});
  recorded.apply(SetSprings{{{far, 3.0, setup.mesh.points.col(far)}, {far - 1, 2.0, Vec3d::Zero()}}});
  const auto act = [&](auto& hands, int i) {
    if (i == 2) hands.apply(RemoveTets{{0, 1, 2, 200, 201}});
    if (i == 3) hands.apply(MoveSprings{Mat3X<double>::Constant(3, 2, 0.05)});
  };
  for (int i = 0; i < 10; ++i) {
    act(recorded, i);
    if (i == 4) restored.restore(world.save());
    recorded.advance(frame);
    if (i >= 4) restored.advance(frame);
  }
  CHECK(same_bits(world, restored));
  World<float> again(setup);
  CHECK(replay(recorded.recording(), again).same);
}

TEST_CASE("a command on applied forces that is refused leaves no trace") {
  const Setup setup = half_linear(RegionModel::nonlinear);
  World<double> world(setup);
  world.advance(frame);
  const std::string before = checkpoint_bytes(world.save());
  CHECK_THROWS_AS(world.apply(MoveSprings{Mat3X<double>::Zero(3, 2)}), InputError);
  CHECK_THROWS_AS(world.apply(SetForces{{{-1, Vec3d::Zero()}}}), InputError);
  CHECK_THROWS_AS(world.apply(SetSprings{{{0, -1.0, Vec3d::Zero()}}}), InputError);
  CHECK(checkpoint_bytes(world.save()) == before);
}

TEST_CASE(
    "forces on nothing and springs that are none are refused; what acts on a condensed interior is "
    "reported") {
  Setup setup = half_linear(RegionModel::precomputed);
  World<double> world(setup);
  CHECK_THROWS_AS(world.apply(SetForces{{{setup.mesh.vertex_count(), Vec3d::Zero()}}}), InputError);
  CHECK_THROWS_AS(world.apply(SetForces{{{0, Vec3d::Constant(std::nan(""))}}}), InputError);
  CHECK_THROWS_AS(world.apply(SetSprings{{{0, -1.0, Vec3d::Zero()}}}), InputError);
  CHECK_THROWS_AS(world.apply(MoveSprings{Mat3X<double>::Zero(3, 2)}), InputError);
  CHECK(world.advance(frame).conditions.empty());
  Index inside = 0;
  while (!world.body().regions.is_interior(inside)) ++inside;
  world.apply(SetForces{{{inside, Vec3d(0, 0, 0.001)}}});
  const Report report = world.advance(frame);
  REQUIRE(report.conditions.size() == 1);
  CHECK(report.conditions[0].kind == Condition::Kind::lost_force);
}
