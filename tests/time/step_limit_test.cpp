#include "lobe/numerics/lanczos.h"

#include <doctest/doctest.h>

#include "lobe/fem/hooke.h"
#include "lobe/io/mesh_io.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rest_time_step.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// All of M^-½ K M^-½ as a dense matrix: ω_max without any iteration.
double dense_frequency(const Setup& setup) {
  const Elements elements(setup);
  const Index n = setup.mesh.vertex_count();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        K.block<3, 3>(3 * setup.mesh.tets(i, t), 3 * setup.mesh.tets(j, t)) +=
            s.volume * hooke_block<double>(s.gradients.col(i), s.gradients.col(j), e.lambda, e.mu);
  }
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      K.block<3, 3>(3 * i, 3 * j) /= std::sqrt(lumped_mass(elements, i) * lumped_mass(elements, j));
  return std::sqrt(symmetric_eigenvalues(K).maxCoeff());
}

// The same from differences of a world's forces at rest, whatever they are.
double dense_frequency_of_forces(const Setup& setup) {
  World<double> world(setup);
  State<double> state = world.state();
  Eigen::MatrixXd K(state.u.size(), state.u.size());
  const double h = 1e-7;
  for (Index i = 0; i < state.u.size(); ++i) {
    state.u(i) = h;
    world.set_state(state);
    K.col(i) = -world.forces().reshaped();
    state.u(i) = -h;
    world.set_state(state);
    K.col(i) = (K.col(i) + world.forces().reshaped()) / (2 * h);
    state.u(i) = 0;
  }
  for (Index i = 0; i < K.rows(); ++i)
    for (Index j = 0; j < K.cols(); ++j)
      K(i, j) /= std::sqrt(world.body().inertia.mass()[i / 3] * world.body().inertia.mass()[j / 3]);
  return std::sqrt(symmetric_eigenvalues(K).maxCoeff());
}

// A jittered box with nodal pressure.
Setup averaged_box(int n, double ratio, double share) {  // ratio: λ/μ
  Setup setup = setup_of(irregular_box(n));
  setup.materials[0].lambda = ratio * setup.materials[0].mu;
  return averaged(setup, share);
}

constexpr double ratios[] = {9, 99, 499};  // ν = 0.45, 0.495, 0.499

// Held at its back, under more than its weight, with a volume term.
Setup sagging_liver() {
  Setup setup = setup_of(read_mesh(LOBE_DATA_DIR "/meshes/liver_10k.vtu").mesh);
  setup.volume_penalty = 1e5;
  setup.damping = 15;
  setup.gravity = {0, 0, -25};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const Vec3d x = setup.mesh.points.col(v); x.x() < -0.02 && x.y() > 0.015)
      setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

// Of the forces at the state of a world, by many iterations.
double exact_frequency(World<double>& world) {
  const Checkpoint<double> now = world.save();
  const Index vertices = world.elements().topology.vertex_count();
  std::vector<double> inverse_mass;
  for (Index v = 0; v < vertices; ++v) {
    const double mass = world.body().inertia.mass()[std::size_t(v)];
    inverse_mass.push_back(mass > 0 && !world.held().fixes(v) ? 1 / mass : 0);
  }
  const auto forces = [&](const Mat3X<double>& u) -> Mat3X<double> {
    world.set_state({u, Mat3X<double>::Zero(3, vertices), 0});
    return world.forces();
  };
  const Mat3X<double> there = forces(now.state.u);
  const HighestFrequency found = highest_frequency<double>(
      inverse_mass, [](Index) { return 1.0; }, 1e-8,
      [&](const Mat3X<double>& u, Mat3X<double>& f) { f += forces(now.state.u + u) - there; }, {1e-7, 1000});
  world.restore(now);
  REQUIRE(found.converged);
  return found.omega;
}

bool keeps_its_energy(const Setup& setup, double factor, int steps) {
  World<double> world(setup);
  State<double> state = world.state();
  state.v = random_displacement(setup.mesh.vertex_count(), 1e-6);
  world.set_state(state);
  const double before = world.energies().total(), dt = factor * world.time_step_limit();
  for (int i = 0; i < steps; ++i) world.step(dt);
  return world.energies().total() < 10 * before;  // not if it is no number
}

}  // namespace

TEST_CASE(
    "the time step limit is within 1 % of 2/ω_max of a dense eigenvalue solution, and on the safe side of "
    "1.001") {
  for (RegionModel model : {RegionModel::tensor_mass, RegionModel::nonlinear}) {
    const Setup setup = setup_of(irregular_box(4), model);
    const double exact = 2 / dense_frequency(setup);
    World<double> world(setup);
    CHECK(world.time_step_limit() / exact == near(1, 0.01));
    CHECK(world.time_step_limit() < 1.001 * exact);
    CHECK(rest_time_step(setup.mesh, seed_material) == near(world.time_step_limit(), 1e-9));
  }
}

TEST_CASE("the time step at rest of a material with nodal pressure is that of non-linear tetrahedra") {
  Setup setup = setup_of(irregular_box(3), RegionModel::nonlinear);
  setup.materials[0].lambda = 30 * setup.materials[0].mu;
  const double plain = World<double>(setup).time_step_limit();
  setup.materials[0].nodal_pressure = 1;
  const double limit = World<double>(setup).time_step_limit();
  CHECK(limit > 1.05 * plain);
  CHECK(rest_time_step(setup.mesh, setup.materials[0]) == near(limit, 1e-9));
}

TEST_CASE("on an organ 2/ω_max is found to 1 % in fewer than 50 evaluations of forces") {
  const TetMesh mesh = read_mesh(LOBE_DATA_DIR "/meshes/liver_2k.vtu").mesh;
  for (double share : {0.0, 1.0}) {
    World<double> world(averaged(setup_of(mesh), share));
    const double exact = exact_frequency(world);
    CHECK(world.step_limit().search().converged);
    CHECK(world.step_limit().search().evaluations < 50);
    CHECK(world.time_step_limit() * exact / 2 == near(1, 0.01));
  }
}

TEST_CASE("on a deformed and cut organ the limit is within 3 % of 2/ω_max of the forces there") {
  World<double> world(sagging_liver());
  const double rest_ratio =
      2 / world.time_step_limit() / world.step_limit().highest_vertex(world.body()).omega;
  for (double until : {1.0, 1.5}) {
    while (world.time() < until) REQUIRE(world.advance(0.02).reruns == 0);
    const double limit = world.time_step_limit(), exact = 2 / exact_frequency(world);
    CHECK(world.time_step_limit() == limit);  // restored
    CHECK(limit < 1.005 * exact);
    CHECK(limit > 0.97 * exact);
    CHECK(2 / (rest_ratio * world.step_limit().highest_vertex(world.body()).omega) <
          0.95 * exact);  // with the ratio at rest
    world.remove_tets({0, 300, 600, 900});
  }
}

TEST_CASE("the vertex estimate is a lower bound of ω_max within 25 % on an irregular box") {
  const Setup setup = hybrid_setup(irregular_box(4));
  World<double> world(setup);
  const double exact = dense_frequency(setup);
  CHECK(world.step_limit().highest_vertex(world.body()).omega < exact);
  CHECK(world.step_limit().highest_vertex(world.body()).omega > 0.75 * exact);
}

TEST_CASE("steps at 0.9 of the limit are stable for a long time, at 1.1 they are not") {
  const Setup setup = setup_of(irregular_box(3), RegionModel::tensor_mass);
  CHECK(keeps_its_energy(setup, 0.9, 20000));
  CHECK(!keeps_its_energy(setup, 1.1, 20000));
}

TEST_CASE("with nodal pressure the limit is within 1 % of that of the forces at rest") {
  for (double ratio : ratios)
    for (double share : {0.9, 1.0}) {
      const Setup setup = averaged_box(4, ratio, share);
      const double exact = 2 / dense_frequency_of_forces(setup);
      World<double> world(setup);
      CHECK(world.time_step_limit() / exact == near(1, 0.01));
      CHECK(world.step_limit().highest_vertex(world.body()).omega < 2 / exact);
      CHECK(world.time_step_limit() > 1.3 * World<double>(averaged(setup, 0)).time_step_limit());
    }
}

TEST_CASE("with nodal pressure steps at 0.99 of the limit are stable for long, at 1.02 they are not") {
  for (double ratio : ratios) {
    const Setup setup = averaged_box(3, ratio, 1);
    CHECK(keeps_its_energy(setup, 0.99, 100000));
    CHECK(!keeps_its_energy(setup, 1.02, 20000));
  }
}

TEST_CASE(
    "with smoothed edges the limit is within 1 % of that of the forces at rest, and longer than that of "
    "plain ones") {
  for (double ratio : ratios)
    for (double share : {0.0, 1.0}) {
      const Setup plain = averaged_box(4, ratio, 0), setup = smoothed(averaged_box(4, ratio, share));
      const double exact = 2 / dense_frequency_of_forces(setup);
      World<double> world(setup);
      CHECK(world.time_step_limit() / exact == near(1, 0.01));
      CHECK(world.step_limit().highest_vertex(world.body()).omega < 2 / exact);
      CHECK(world.time_step_limit() > 1.05 * World<double>(plain).time_step_limit());
    }
}

TEST_CASE("with smoothed edges steps at 0.99 of the limit are stable for long, at 1.02 they are not") {
  for (double share : {0.0, 1.0}) {
    const Setup setup = smoothed(averaged_box(3, 4, share));
    CHECK(keeps_its_energy(setup, 0.99, 100000));
    CHECK(!keeps_its_energy(setup, 1.02, 20000));
  }
}

TEST_CASE("the limit follows the deformation: a stretched body is stiffer") {
  const TetMesh mesh = irregular_box(3);
  World<double> world(setup_of(mesh));
  const double at_rest = world.time_step_limit();
  State<double> state = world.state();
  state.u = affine_displacement(mesh.points, 1.5 * Mat3<double>::Identity());
  world.set_state(state);
  // K at F = sI: s² times the rest stiffness plus the geometric part: shorter than 1/s
  CHECK(world.time_step_limit() < at_rest / 1.5);
}
