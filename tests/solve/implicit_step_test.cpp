#include "lobe/solve/implicit_step.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "fibre_support.h"
#include "lobe/error.h"
#include "lobe/sim/world.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup beam(RegionModel model) {
  Setup setup = setup_of(box_mesh({0.06, 0.02, 0.02}, 6, 2, 2), model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

Setup fibrous_beam(RegionModel model) {
  Setup setup = beam(model);
  setup.materials = {fibrous()};
  setup.mesh.fibres = Vec3d(1, 0.5, 1).normalized().replicate(1, setup.mesh.tet_count());
  return setup;
}

Setup implicit(Setup setup, double spectral_radius) {
  setup.integrator = Integrator::generalised_alpha;
  setup.spectral_radius = spectral_radius;
  return setup;
}

Mat3X<double> after(const Setup& setup, double time, int steps) {
  World<double> world(setup);
  for (int i = 0; i < steps; ++i) REQUIRE(world.step(time / steps));
  return world.state().u;
}

}  // namespace

TEST_CASE("implicit dynamics are of second order, and agree with small explicit steps") {
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass})
    for (double rho : {1.0, 0.5}) {
      const Setup setup = implicit(beam(model), rho);
      const double time = 0.05;
      const Mat3X<double> u1 = after(setup, time, 80), u2 = after(setup, time, 160),
                          u4 = after(setup, time, 320);
      CHECK(std::log2((u1 - u2).norm() / (u2 - u4).norm()) > 1.9);
      Setup reference = beam(model);
      const Mat3X<double> u = after(reference, time, 4000);
      const Mat3X<double> extrapolated = u4 + (u4 - u2) / 3;
      CHECK((extrapolated - u).norm() < 1e-3 * u.norm());
    }
}

TEST_CASE("implicit dynamics with fibres agree with small explicit steps, and end in the static solution") {
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass}) {
    const double time = 0.05;
    const Mat3X<double> u2 = after(implicit(fibrous_beam(model), 1), time, 160),
                        u4 = after(implicit(fibrous_beam(model), 1), time, 320),
                        u = after(fibrous_beam(model), time, 4000), extrapolated = u4 + (u4 - u2) / 3;
    CHECK((extrapolated - u).norm() < 1e-3 * u.norm());
    CHECK((after(beam(model), time, 4000) - u).norm() > 0.05 * u.norm());  // the fibres are felt
    Setup damped = implicit(fibrous_beam(model), 0.5);
    damped.damping = 30;
    World<double> world(damped);
    for (int i = 0; i < 120; ++i) REQUIRE(world.advance(1.0 / 30).steps == 1);
    const StaticResult rest = solve_static(damped);
    CHECK((world.state().u - rest.u).norm() < 1e-8 * rest.u.norm());
  }
}

TEST_CASE("the implicit midpoint rule keeps linear and angular momentum, and a linear model's energy") {
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass}) {
    Setup setup = implicit(setup_of(irregular_box(2), model), 1);
    World<double> world(setup);
    State<double> state = world.state();
    state.v = random_displacement(setup.mesh.vertex_count(), model == RegionModel::nonlinear ? 0.2 : 0.02);
    world.set_state(state);
    const auto momentum = [&] {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
        const Vec3d p = world.body().inertia.mass()[v] * world.state().v.col(v);
        sum.head<3>() += p;
        sum.tail<3>() += (setup.mesh.points.col(v) + world.state().u.col(v)).cross(p);
      }
      return sum;
    };
    const Eigen::Matrix<double, 6, 1> before = momentum();
    const double energy = world.energies().total();
    for (int i = 0; i < 50; ++i) REQUIRE(world.step(2e-3));
    CHECK((momentum() - before).head<3>().norm() < 1e-9 * before.head<3>().norm());
    if (model == RegionModel::nonlinear)  // a linear model's forces have a moment once it has turned
      CHECK((momentum() - before).tail<3>().norm() < 1e-8 * before.tail<3>().norm());
    else
      CHECK(world.energies().total() == near(energy, 1e-9));
  }
}

TEST_CASE("steps far above the explicit limit end in the static solution") {
  Setup setup = implicit(hybrid_setup(box_mesh({0.06, 0.02, 0.02}, 6, 2, 2)), 0.5);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  setup.damping = 30;
  const StaticResult rest = solve_static(setup);
  World<double> world(setup);
  CHECK(world.time_step_limit() < 0.002);
  for (int i = 0; i < 60; ++i) REQUIRE(world.advance(1.0 / 30).steps == 1);
  CHECK((world.state().u - rest.u).norm() < 1e-8 * rest.u.norm());
}

TEST_CASE("an implicit world follows grasps, rollers and cuts") {
  Setup setup = implicit(beam(RegionModel::nonlinear), 0.8);
  setup.damping = 20;
  setup.implicit_step = 0.01;
  setup.prescribed.push_back({setup.mesh.vertex_count() - 1, Vec3d::Zero(), {false, true, false}});
  const Index tip = 6;  // at (0.06, 0, 0)
  setup.grasps.push_back({"grasp", {tip}, {{0, Vec3d::Zero()}, {0.3, {0.005, 0, 0.01}}}, true});
  World<double> world(setup);
  Setup same = setup;
  same.integrator = Integrator::central_difference;
  World<double> reference(same);
  for (int i = 0; i < 9; ++i) {
    CHECK(world.advance(1.0 / 30).ok);
    reference.advance(1.0 / 30);
  }
  CHECK((world.state().u.col(tip) - Vec3d(0.005, 0, 0.01)).norm() < 1e-12);
  CHECK(world.state().u(1, setup.mesh.vertex_count() - 1) == 0);
  CHECK((world.state().u - reference.state().u).norm() < 0.05 * reference.state().u.norm());
  CHECK(world.remove_tets({100, 101, 102}) == 3);
  for (int i = 0; i < 120; ++i) CHECK(world.advance(1.0 / 30).ok);
  CompactMesh compacted;
  const StaticResult rest = solve_static(world.current_setup(compacted));
  const Mat3X<double> u = world.state().u(Eigen::all, compacted.vertex_source);
  CHECK((u - rest.u).norm() < 1e-6 * rest.u.norm());
}

TEST_CASE("an implicit world that is held everywhere stays") {
  Setup setup = implicit(beam(RegionModel::nonlinear), 0.8);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, Vec3d::Zero()});
  CHECK(after(setup, 0.1, 3).isZero(0));
}

TEST_CASE("a world that is moved goes on as if it had stayed") {
  const Setup setup = implicit(beam(RegionModel::nonlinear), 0.8);
  World<double> stays(setup);
  auto first = std::make_unique<World<double>>(setup);
  for (World<double>* world : {&stays, first.get()}) REQUIRE(world->step(0.005));
  World<double> moved = std::move(*first);
  first.reset();
  for (World<double>* world : {&stays, &moved}) REQUIRE(world->step(0.005));
  CHECK(moved.state().u == stays.state().u);
}

TEST_CASE("the implicit integrator asks for double precision and sane constants") {
  CHECK_THROWS_WITH_AS(World<float>(implicit(beam(RegionModel::nonlinear), 1)),
                       doctest::Contains("double precision"), InputError);
  CHECK_THROWS_WITH_AS(World<double>(implicit(beam(RegionModel::nonlinear), 1.5)),
                       doctest::Contains("spectral_radius"), InputError);
}
