// A pre-computed region in a frame that turns with it.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "condense/half_linear.h"
#include "fibre_support.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup corotated(Setup setup) {
  setup.precomputed_frame = RegionFrame::corotated;
  return setup;
}

Setup floating(int n = 4) {
  Setup setup = corotated(half_linear(RegionModel::precomputed, n));
  setup.prescribed.clear();
  return setup;
}

Mat3<double> turn(double degrees) {
  return Eigen::AngleAxisd(degrees * std::acos(-1.0) / 180, Vec3d(1, -2, 0.5).normalized())
      .toRotationMatrix();
}

// The body turned, and every vertex moved by up to `size` [m] besides.
template <class Real>
void place(World<Real>& world, const Mat3<double>& R, double size) {
  State<Real> state = random_state(world, size);
  const Mat3X<double> X = world.elements().points.view();
  state.u += affine_displacement(X, R).template cast<Real>();
  world.set_state(state);
}

Setup floating_with_fibres() {
  Setup setup = floating();
  setup.materials[0] = fibrous();
  setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  return setup;
}

bool is_led(World<double>& world, Index v) {
  return world.body().inertia.mass()[v] > 0 && !world.held().holds(v);
}

}  // namespace

TEST_CASE("a floating body with a corotated region turns as a whole without a force") {
  World<double> world(floating());
  place(world, Mat3<double>::Identity(), 1e-3);
  const double scale = world.forces().norm();
  for (double degrees : {90.0, 170.0}) {
    place(world, turn(degrees), 0);
    const Mat3X<double> u = affine_displacement(world.elements().points.view(), turn(degrees));
    CHECK(world.forces().norm() < 1e-12 * scale);
    CHECK((world.state().u - u).norm() < 1e-12 * u.norm());
    CHECK(world.energies().total() < 1e-20);
  }
}

TEST_CASE("forces turn with a corotated body, and so do its fibres") {
  Mat3X<double> isotropic;
  for (const Setup& setup : {floating(), floating_with_fibres()}) {
    World<double> world(setup);
    place(world, Mat3<double>::Identity(), 1e-3);
    const Mat3X<double> u = world.state().u, f = world.forces(), X = world.elements().points.view();
    State<double> state = world.state();
    const Mat3<double> R = turn(130);
    state.u = R * (X + u) - X;
    world.set_state(state);
    CHECK((world.forces() - R * f).norm() < 1e-12 * f.norm());
    if (setup.mesh.fibres.cols() == 0)
      isotropic = f;
    else
      CHECK((f - isotropic).norm() > 0.1 * f.norm());
  }
}

TEST_CASE("a floating body with a corotated region keeps its momentum and angular momentum") {
  World<double> world(floating(3));
  place(world, turn(40), 5e-4);
  State<double> state = world.state();
  state.v = random_displacement(static_cast<Index>(state.v.cols()), 0.05);
  const Mat3X<double> x = world.elements().points.view() + state.u;
  const Vec3d middle = x.rowwise().mean();
  for (Index v = 0; v < state.v.cols(); ++v)
    state.v.col(v) += Vec3d(0.1, 0.05, -0.2) + Vec3d(3, 1, -2).cross(x.col(v) - middle);
  world.set_state(state);
  struct Momenta {
    Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();
  };
  const auto momenta = [&] {
    Momenta sum;
    for (Index v = 0; v < world.elements().topology.vertex_count(); ++v) {
      const Vec3d p = world.body().inertia.mass()[v] * world.state().v.col(v);
      sum.linear += p;
      sum.angular += Vec3d(world.elements().points.col(v) + world.state().u.col(v) - middle).cross(p);
    }
    return sum;
  };
  const Momenta before = momenta();
  const double limit = world.time_step_limit();
  const double coarse = energy_drift(world, 0.2 * limit, 3000);
  const Momenta after = momenta();
  CHECK((after.linear - before.linear).norm() < 1e-11 * before.linear.norm());
  CHECK((after.angular - before.angular).norm() < 1e-11 * before.angular.norm());
  const auto long_way = [](const Mat3X<double>& at) -> Vec3d {
    return (at.col(at.cols() - 1) - at.col(0)).normalized();
  };
  const Mat3X<double> after_it = world.elements().points.view() + world.state().u;
  CHECK(long_way(after_it).dot(long_way(x)) < 0.8);  // it has turned indeed
  world.set_state(state);
  const double fine = energy_drift(world, 0.1 * limit, 6000);
  CHECK(coarse < 5e-3);
  CHECK(fine < coarse / 3.5);
}

TEST_CASE(
    "the forces of a corotated region are the derivative of its energy, loads of the interior included") {
  for (bool is_held : {false, true}) {
    CAPTURE(is_held);
    Setup setup = floating(3);
    if (is_held) setup.prescribed = half_linear(RegionModel::precomputed, 3).prescribed;
    load(setup);
    setup.gravity *= 20;
    World<double> world(setup);
    place(world, is_held ? Mat3<double>::Identity() : turn(75), 2e-3);
    const State<double> state = world.state();
    const Mat3X<double> f = world.forces();
    const double scale = f.colwise().norm().maxCoeff(), h = 1e-6;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
      if (!is_led(world, v)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        double energy[2];
        for (int side : {0, 1}) {
          State<double> moved = state;
          moved.u(axis, v) += side == 0 ? -h : h;
          world.set_state(moved);
          energy[side] = world.energies().total();
        }
        CHECK(std::abs(f(axis, v) + (energy[1] - energy[0]) / (2 * h)) < 1e-6 * scale);
      }
    }
  }
}

TEST_CASE(
    "resting on its frame, a region under gravity weighs what it weighs, and turns where its weight turns "
    "it") {
  Setup setup = floating(3);
  load(setup);
  World<double> world(setup);
  place(world, turn(110), 1e-3);
  Vec3d force = Vec3d::Zero(), torque = force, expected_torque = force;
  double mass = 0;
  const Mat3X<double> x = world.elements().points.view() + world.state().u;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    force += world.forces().col(v);
    torque += x.col(v).cross(world.forces().col(v));
    mass += lumped_mass(world.elements(), v);
    expected_torque += x.col(v).cross(lumped_mass(world.elements(), v) * setup.gravity);
  }
  Vec3d expected = mass * setup.gravity;
  for (const VertexLoad& l : setup.vertex_loads) {
    expected += l.force;
    expected_torque += x.col(l.vertex).cross(l.force);
  }
  CHECK((force - expected).norm() < 1e-10 * expected.norm());
  CHECK((torque - expected_torque).norm() < 1e-10 * expected_torque.norm());
}

TEST_CASE("what moves little moves a corotated region as a fixed one, to second order") {
  Setup fixed = half_linear(RegionModel::precomputed, 4);
  for (PrescribedVertex& held : fixed.prescribed)
    held.axes = all_axes;  // what slides is the interior of one alone
  World<double> plain(fixed), turning(corotated(fixed));
  const State<double> state = random_state(plain, 1);
  const auto difference = [&](double size) {
    State<double> small = state;
    small.u *= size;
    plain.set_state(small);
    turning.set_state(small);
    double sum = 0;
    for (Index v = 0; v < fixed.mesh.vertex_count(); ++v)
      if (is_led(plain, v)) sum += (plain.forces() - turning.forces()).col(v).squaredNorm();
    return std::sqrt(sum);
  };
  const double coarse = difference(2e-4), fine = difference(1e-4);
  CHECK(fine > 0);
  CHECK(coarse / fine == near(4, 0.02));
}

TEST_CASE("cuts and changes of a corotated region leave what would be condensed afresh") {
  for (bool is_held : {false, true}) {
    CAPTURE(is_held);
    Setup setup = floating(4);
    if (is_held) setup.prescribed = half_linear(RegionModel::precomputed, 4).prescribed;
    load(setup);
    World<double> world(setup);
    place(world, is_held ? Mat3<double>::Identity() : turn(60), 1e-3);
    const Index tets = setup.mesh.tet_count(), batch = 20;
    std::vector<Index> order(std::size_t(tets), 0);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    world.apply(SetRegion{{order.begin(), order.begin() + 15}, RegionModel::tensor_mass});
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
    for (Index i = 0; i < tets; i += batch) {
      CAPTURE(i);
      world.remove_tets({order.begin() + i, order.begin() + std::min(tets, i + batch)});
      const RebuildDifference d = compare_with_rebuilt(world);
      CHECK(d.mass < 1e-9);
      CHECK(d.force < 1e-9);
      CHECK(d.interior < 1e-9);
      CHECK(d.largest() < 1e-9);
    }
    CHECK(world.forces().norm() == 0);
  }
}

TEST_CASE(
    "a corotated region follows the same bits on two and seven threads and from a checkpoint, in single "
    "precision, "
    "too") {
  Setup setup = floating(6);
  setup.damping = 20;
  setup.cauteries.push_back({"bipolar", 0.009, {{0, {0.01, -0.02, 0.06}}, {0.2, {0.045, 0.07, 0.03}}}});
  setup.grasps.push_back({"grasper", {14, 50, 51, 52}, {{0.03, {0, 0, 0}}, {0.15, {0.01, 0.02, 0}}}, true});
  World<float> first(setup, 1), second(setup, 2), third(setup, 7);
  World<double> exact(setup);
  for (int i = 0; i < 8; ++i) {
    REQUIRE(first.advance(0.03).ok);
    second.advance(0.03);
    exact.advance(0.03);
    if (i < 3) continue;
    if (i == 3)
      third.restore(first.save());
    else
      third.advance(0.03);
    CHECK(first.state().u == second.state().u);
    CHECK(first.state().u == third.state().u);
  }
  CHECK(compare_with_rebuilt(exact).largest() < 1e-9);
  CHECK((first.state().u.cast<double>() - exact.state().u).norm() < 1e-3 * exact.state().u.norm());
}

TEST_CASE("a lobe that hangs from a turned stem is where St Venant-Kirchhoff has it, but for its frame") {
  Setup setup = setup_of(box_mesh({0.08, 0.02, 0.02}, 8, 2, 2));
  setup.gravity = {0, 0, -3};
  const Mat3<double> R = Eigen::AngleAxisd(std::acos(-1.0) / 4, Vec3d::UnitY()).toRotationMatrix();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-6)
      setup.prescribed.push_back({v, (R - Mat3<double>::Identity()) * setup.mesh.points.col(v)});
  const Mat3X<double> exact = solve_static(setup).u;
  setup.precomputed_frame = RegionFrame::corotated;
  setup.damping = 40;
  Setup linear = setup;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() > 0.03) {
      setup.region_of[t] = RegionModel::precomputed;
      linear.region_of[t] = RegionModel::tensor_mass;
    }
  CHECK_THROWS_WITH_AS(solve_static(setup), doctest::Contains("corotated"), InputError);
  World<double> world(setup);
  for (int i = 0; i < 60; ++i) REQUIRE(world.advance(0.05).ok);
  const auto error = [&](const Mat3X<double>& u) { return (u - exact).norm() / exact.norm(); };
  const double with_frame = error(world.state().u), without = error(solve_static(linear).u);
  CAPTURE(with_frame);
  CAPTURE(without);
  CHECK(with_frame < 0.001);
  CHECK(without > 0.2);
}

TEST_CASE("a corotated region is one part, with an interface that is no line") {
  Setup setup = floating(4);
  const auto far = [&](Index t) { return barycentre(setup.mesh, t).x() > 0.035; };
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (far(t)) setup.region_of[t] = RegionModel::precomputed;
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("outside of the largest part"), InputError);
  Setup alone = setup;
  std::fill(alone.region_of.begin(), alone.region_of.end(), RegionModel::precomputed);
  CHECK_THROWS_WITH_AS(World<double>{alone}, doctest::Contains("not in line"), InputError);
}
