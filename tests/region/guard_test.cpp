#include <doctest/doctest.h>

#include <numeric>

#include "lobe/region/nonlinear.h"
#include "lobe/solve/tangent.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup guarded(double kappa = 0) {
  Setup setup = setup_of(irregular_box(3));
  setup.guard_below = 0.3;
  setup.volume_penalty = kappa;
  return setup;
}

// Some tetrahedra are crushed, some inverted.
Mat3X<double> violent(const Setup& setup) { return random_displacement(setup.mesh.vertex_count(), 5e-3); }

}  // namespace

TEST_CASE("guarded forces and energy are those of the element by element reference") {
  for (double kappa : {0.0, 1e5})
    for (double share : {0.0, 0.5}) {
      Setup setup = averaged(guarded(kappa), share);
      const Mat3X<double> u = violent(setup);
      const EnergyAndForces reference = energy_and_forces(Elements(setup), u);
      CHECK(reference.smallest_volume_ratio < 0);
      CHECK((forces<double>(setup, u) - reference.forces).norm() < 1e-12 * reference.forces.norm());
      CHECK(elastic_energy(setup, u) == near(reference.energy, 1e-12));
      const Mat3X<float> single = forces<float>(setup, u.cast<float>());
      CHECK((single.cast<double>() - reference.forces).norm() < 1e-4 * reference.forces.norm());
    }
}

TEST_CASE("the guarded forces are minus the slope of the energy, and conserve momentum") {
  const Setup setup = guarded();
  const Mat3X<double> u = violent(setup), f = forces<double>(setup, u);
  check_that_forces_are_minus_the_slope_of_the_energy(setup, u);
  CHECK(f.rowwise().sum().norm() < 1e-12 * f.norm());
}

TEST_CASE_TEMPLATE("where no tetrahedron is below the threshold the guard changes no bit", Real, float,
                   double) {
  for (double kappa : {0.0, 1e5}) {
    const Setup with = guarded(kappa);
    Setup without = with;
    without.guard_below = 0;
    const Mat3X<Real> u = random_displacement<Real>(with.mesh.vertex_count(), 8e-4);
    CHECK(energy_and_forces(Elements(without), u.template cast<double>()).smallest_volume_ratio > 0.3);
    CHECK(forces<Real>(with, u) == forces<Real>(without, u));
    const Mat3X<Real> far = violent(with).template cast<Real>();
    CHECK(forces<Real>(with, far) != forces<Real>(without, far));
  }
}

TEST_CASE("the time step follows the guard: its diagonal stiffness is that of the tangent") {
  const Setup setup = guarded(1e5);
  const Elements elements(setup);
  const Mat3X<double> u = violent(setup);
  RegionEdit edit;
  edit.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  NonlinearRegion<double> region;
  region.follow(elements, edit);
  DiagonalStiffness K = DiagonalStiffness::Zero(6, u.cols()), expected = K;
  Parallel one_thread;
  region.add_diagonal_stiffness(u, K, one_thread);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Eigen::Vector4i v = elements.topology.corners(t);
    const TetStiffness stiffness = tet_stiffness(elements, t, u(Eigen::all, v));
    for (int c = 0; c < 4; ++c) {
      const Mat3<double> B = stiffness.block<3, 3>(3 * c, 3 * c);
      expected.col(v[c]) += Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    }
  }
  CHECK((K - expected).norm() < 1e-12 * expected.norm());
}

TEST_CASE_TEMPLATE("a body that starts mirrored, held at one face, turns back and comes to rest", Real, float,
                   double) {
  Setup setup = guarded();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 30;
  World<Real> world(setup);
  State<Real> state = world.state();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (!world.held().holds(v)) state.u(2, v) = Real(-2 * setup.mesh.points(2, v));
  world.set_state(state);
  CHECK(world.advance(1e-3).smallest_volume_ratio < -0.5);
  for (int i = 0; i < 60; ++i) REQUIRE(world.advance(0.05).ok);
  CHECK(world.state().u.norm() < 1e-4);
}
