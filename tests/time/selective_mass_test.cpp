#include "lobe/time/selective_mass.h"
#include "lobe/linearity/mass_watch.h"

#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "fibre_support.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A jittered box, free or held at one side, with two materials.
Setup box(bool held, int degree, int n = 3) {
  Setup setup = setup_of(irregular_box(n));
  setup.materials.push_back({1e5, 3e4, 1200});
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = barycentre(setup.mesh, t).x() > 0.02;
  for (Index v = 0; held && v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.selective_mass = degree;
  return setup;
}

// C, column by column, on 3 × #vertices.
Eigen::MatrixXd inverse_mass(const Setup& setup, int degree) {
  const Elements elements(setup);
  const Index n = setup.mesh.vertex_count();
  std::vector<double> inverse;
  for (Index v = 0; v < n; ++v) inverse.push_back(1 / lumped_mass(elements, v));
  const HeldVertices held = held_by(setup.prescribed);
  std::vector<HeldVertices::Held> sliding;
  for (const HeldVertices::Held& item : held.all())
    if (item.axes == all_axes)
      inverse[std::size_t(item.vertex)] = 0;
    else
      sliding.push_back(item);
  std::vector<Index> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  SelectiveMass<double> mass;
  mass.set_degree(degree);
  mass.follow(elements, all, [](Index) { return true; });
  mass.measure(moving_vertices<double>(inverse));
  mass.set_moving(moving_vertices<double>(inverse));
  Parallel parallel;
  Eigen::MatrixXd C(3 * n, 3 * n);
  for (Index i = 0; i < 3 * n; ++i) {
    Mat3X<double> f = Mat3X<double>::Zero(3, n);
    f(i % 3, i / 3) = 1;
    mass.apply(sliding, parallel, f);
    for (Index v = 0; v < n; ++v) f.col(v) *= inverse[std::size_t(v)];
    C.col(i) = f.reshaped();
  }
  return C;
}

Mat3X<double> random_velocities(Index count) {  // [m/s]
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1e-3, 1e-3);
  Mat3X<double> v(3, count);
  for (double& x : v.reshaped()) x = uniform(random);
  return v;
}

// Of the forces of a world at rest.
Eigen::MatrixXd stiffness(const Setup& setup) {
  Setup lumped = setup;
  lumped.selective_mass = 1;
  World<double> world(lumped);
  State<double> state = world.state();
  Eigen::MatrixXd K(state.u.size(), state.u.size());
  const double h = 1e-8;
  for (Index i = 0; i < state.u.size(); ++i) {
    state.u.reshaped()[i] = h;
    world.set_state(state);
    K.col(i) = -world.forces().reshaped() / h;
    state.u.reshaped()[i] = 0;
  }
  for (const PrescribedVertex& p : setup.prescribed)
    for (int axis = 0; axis < 3; ++axis) {
      K.row(3 * p.vertex + axis).setZero();
      K.col(3 * p.vertex + axis).setZero();
    }
  return (K + K.transpose()) / 2;
}

Setup liver(int degree) {
  Setup setup = setup_of(read_mesh(LOBE_DATA_DIR "/meshes/liver_2k.vtu").mesh);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const Vec3d x = setup.mesh.points.col(v); x.x() < -0.02 && x.y() > 0.015)
      setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.volume_penalty = 1e5;
  setup.selective_mass = degree;
  return setup;
}

// The largest ω² of C K, in the symmetric form √C K √C.
double highest_square(const Eigen::MatrixXd& C, const Eigen::MatrixXd& K) {
  const auto [values, Q] = symmetric_eigen<Eigen::MatrixXd>((C + C.transpose()) / 2);
  const Eigen::MatrixXd root = Q * values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * Q.transpose();
  return symmetric_eigenvalues<Eigen::MatrixXd>(root * (K + K.transpose()) / 2 * root).maxCoeff();
}

}  // namespace

TEST_CASE("C is symmetric and positive definite, at most the lumped M⁻¹, and gives a body its acceleration") {
  for (int degree : {2, 3, 5, 9, 16}) {
    CAPTURE(degree);
    const Setup setup = box(false, degree);
    const Eigen::MatrixXd C = inverse_mass(setup, degree);
    CHECK((C - C.transpose()).norm() < 1e-12 * C.norm());
    const Elements elements(setup);
    Eigen::VectorXd root(C.rows()), uniform(C.rows());
    for (Index i = 0; i < C.rows(); ++i) {
      const double m = lumped_mass(elements, i / 3);
      root[i] = std::sqrt(m);
      uniform[i] = i % 3 == 1 ? m : 0;
    }
    const Eigen::VectorXd P = symmetric_eigenvalues<Eigen::MatrixXd>(root.asDiagonal() * (C + C.transpose()) /
                                                                     2 * root.asDiagonal());
    CHECK(P.minCoeff() > 1e-4);
    CHECK(P.maxCoeff() < 1 + 1e-12);
    const Eigen::VectorXd a = C * uniform;
    for (Index i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - (i % 3 == 1)) < 1e-12);
  }
}

TEST_CASE("the limit of the time step is that of a dense eigenvalue solution, with every degree") {
  for (bool held : {false, true})
    for (int degree : {2, 3, 5, 9, 16}) {
      CAPTURE(held);
      CAPTURE(degree);
      const Setup setup = box(held, degree);
      const double highest = highest_square(inverse_mass(setup, degree), stiffness(setup));
      World<double> world(setup);
      const double limit = world.time_step_limit();
      CHECK(limit < 2 / std::sqrt(highest) * 1.005);
      CHECK(limit > 2 / std::sqrt(highest) * 0.97);
    }
}

TEST_CASE("with fibres, too, C is symmetric and the limit that of a dense eigenvalue solution") {
  for (int degree : {3, 9}) {
    CAPTURE(degree);
    Setup setup = fibrous_setup(irregular_box(3));
    setup.selective_mass = degree;
    const Eigen::MatrixXd C = inverse_mass(setup, degree);
    CHECK((C - C.transpose()).norm() < 1e-12 * C.norm());
    const double highest = highest_square(C, stiffness(setup));
    Setup lumped = setup;
    lumped.selective_mass = 1;
    World<double> world(setup), plain(lumped);
    CHECK(world.time_step_limit() < 2 / std::sqrt(highest) * 1.005);
    CHECK(world.time_step_limit() > 2 / std::sqrt(highest) * 0.97);
    CHECK(world.time_step_limit() > 1.3 * plain.time_step_limit());
  }
}

TEST_CASE("on a liver steps are longer by the degree, in both precisions") {
  World<double> lumped(liver(1));
  const double limit = lumped.time_step_limit();
  for (const auto& [degree, gain] : {std::pair{3, 2.0}, {5, 3.0}, {9, 4.9}, {12, 6.2}, {16, 8.2}}) {
    CAPTURE(degree);
    World<double> world(liver(degree));
    CHECK(world.body().inertia.degree() == degree);
    CHECK(world.time_step_limit() > gain * limit);
    World<float> single(liver(degree));
    CHECK(single.time_step_limit() == near(world.time_step_limit(), 0.02));
  }
}

TEST_CASE("nothing changes where the body comes to rest") {
  const auto rest = [](int degree) {
    Setup setup = liver(degree);
    setup.gravity = {0, 0, -9.81};
    setup.damping = 40;
    World<double> world(setup);
    for (int i = 0; i < 100; ++i) REQUIRE(world.advance(0.05).ok);
    return Mat3X<double>(world.state().u);
  };
  const Mat3X<double> lumped = rest(1);
  for (int degree : {5, 12}) CHECK((rest(degree) - lumped).norm() < 1e-6 * lumped.norm());
}

TEST_CASE("an undamped free body keeps its momentum and its energy, at 0.9 of the longer step") {
  for (int degree : {3, 9, 16}) {
    CAPTURE(degree);
    const Setup setup = box(false, degree, 4);
    World<double> world(setup);
    State<double> state = world.state();  // stretched, full of short waves, and moving as a whole
    state.u.row(0) = 1e-4 * setup.mesh.points.row(0);
    state.v = random_velocities(setup.mesh.vertex_count()) / 10;
    state.v.row(1).array() += 1e-3;
    world.set_state(state);
    const auto momentum = [&] {
      Vec3d p = Vec3d::Zero();
      for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
        p += world.body().inertia.mass()[std::size_t(v)] * world.state().v.col(v);
      return p;
    };
    const double dt = 0.9 * world.time_step_limit();
    world.step(dt);
    // ½ v⁻·C⁻¹v⁺ + U, which central differences conserve in a linear body.
    const auto energy = [&](double kinetic, const Energies& e) {
      return kinetic + e.elastic_nonlinear + dt / 2 * world.state().v.cwiseProduct(world.forces()).sum();
    };
    const auto lumped = [&] {
      double sum = 0;
      for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
        sum += world.body().inertia.mass()[std::size_t(v)] * world.state().v.col(v).squaredNorm() / 2;
      return sum;
    };
    const Vec3d momentum_before = momentum();
    const Energies e = world.energies();
    const double before = energy(e.kinetic, e), lumped_before = energy(lumped(), e);
    double change = 0, lumped_change = 0;
    for (int i = 0; i < 20000; ++i) {
      world.step(dt);
      if (i % 100 != 0) continue;
      const Energies now = world.energies();
      change = std::max(change, std::abs(energy(now.kinetic, now) / before - 1));
      lumped_change = std::max(lumped_change, std::abs(energy(lumped(), now) / lumped_before - 1));
    }
    CHECK((momentum() - momentum_before).norm() < 1e-10 * momentum_before.norm());
    CHECK(change < 0.001);
    CHECK(lumped_change > 0.1);
  }
}

TEST_CASE_TEMPLATE("the kinetic energy is that of a dense inverse of C", Real, float, double) {
  for (bool held : {false, true})
    for (int degree : {2, 3, 9, 16}) {
      CAPTURE(held);
      CAPTURE(degree);
      Setup setup = box(held, degree);
      if (held)
        setup.prescribed.push_back({setup.mesh.vertex_count() - 1, Vec3d::Zero(), {true, false, true}});
      const Eigen::MatrixXd C = inverse_mass(setup, degree);
      World<Real> world(setup);
      State<Real> state = world.state();
      state.v = random_velocities(setup.mesh.vertex_count()).cast<Real>();
      std::vector<Index> free;
      for (Index i = 0; i < C.rows(); ++i) {
        if (C(i, i) > 0)
          free.push_back(i);
        else
          state.v.reshaped()[i] = 0;
      }
      world.set_state(state);
      const Eigen::VectorXd v = state.v.reshaped().template cast<double>()(free);
      const double exact = v.dot(Eigen::MatrixXd(C(free, free)).ldlt().solve(v)) / 2;
      double lumped = 0;
      for (Index i = 0; i < state.v.cols(); ++i)
        lumped += world.body().inertia.mass()[std::size_t(i)] * double(state.v.col(i).squaredNorm()) / 2;
      CHECK(exact > 1.5 * lumped);
      CHECK(world.energies().kinetic == near(exact, std::is_same_v<Real, float> ? 1e-4 : 1e-10));
      world.apply(SetMassDegree{1});
      CHECK(world.energies().kinetic == near(lumped, 1e-6));
    }
}

TEST_CASE("to ask for the energy changes nothing") {
  World<double> asked(box(true, 9)), other(box(true, 9));
  for (World<double>* each : {&asked, &other}) {
    State<double> state = each->state();
    state.v = random_velocities(Index(state.v.cols()));
    each->set_state(state);
    REQUIRE(each->advance(0.01).ok);
  }
  asked.energies();
  CHECK(smooth_acceleration(asked.body(), 9).norm == smooth_acceleration(other.body(), 9).norm);
  REQUIRE(asked.advance(0.01).ok);
  REQUIRE(other.advance(0.01).ok);
  CHECK(asked.state().v == other.state().v);
}

TEST_CASE("what is cut goes on as if it had been built so") {
  Setup setup = box(true, 9, 4);
  setup.gravity = {0, 0, -9.81};
  setup.damping = 20;
  World<double> world(setup);
  REQUIRE(world.advance(0.05).ok);
  for (Index t = 100; t < setup.mesh.tet_count(); t += 60) world.remove_tets({t, t + 1});
  CompactMesh c;
  World<double> fresh(world.current_setup(c));
  State<double> state;
  state.u = world.state().u(Eigen::all, c.vertex_source);
  state.v = world.state().v(Eigen::all, c.vertex_source);
  state.time = world.time();
  fresh.set_state(state);
  REQUIRE(world.advance(0.05).ok);
  REQUIRE(fresh.advance(0.05).ok);
  CHECK(world.time_step_limit() == near(fresh.time_step_limit(), 0.03));
  const Mat3X<double> u = world.state().u(Eigen::all, c.vertex_source);
  CHECK((u - fresh.state().u).norm() < 2e-3 * u.norm());  // bounds of the eigenvalues differ a little
}

TEST_CASE_TEMPLATE("the degree may change between frames; a restored world goes on with the same bits", Real,
                   float, double) {
  Setup setup = box(true, 9, 4);
  setup.gravity = {0, 0, -3};
  setup.damping = 20;
  setup.sleep = 2e-3;
  setup.cauteries.push_back(
      {"cautery", 0.006, {{0.25, Vec3d(-0.01, 0.02, 0.02)}, {0.4, Vec3d(0.05, 0.02, 0.03)}}});
  const auto play = [](World<Real>& world, int from, int to) {
    for (int i = from; i < to; ++i) {
      world.apply(SetMassDegree{i % 4 == 0 ? 1 : i % 4 == 1 ? 3 : 9});
      REQUIRE(world.advance(0.02).ok);
    }
  };
  World<Real> world(setup), other(setup, 7);
  play(world, 0, 11);
  const Checkpoint<Real> kept = world.save();
  CHECK(kept.mass_degree == 9);
  CHECK(world.body().sleep.count() > 0);
  play(world, 11, 20);
  other.restore(kept);
  CHECK(other.body().inertia.degree() == 9);
  play(other, 11, 20);
  CHECK(world.state().u == other.state().u);
  CHECK(world.state().v == other.state().v);
  CHECK(world.elements().topology.alive_count() < setup.mesh.tet_count());
}

TEST_CASE("where nothing is left, or all is held, nothing moves") {
  World<double> cut(box(true, 9));
  REQUIRE(cut.advance(0.01).ok);
  std::vector<Index> all(std::size_t(cut.elements().topology.tet_count()));
  std::iota(all.begin(), all.end(), 0);
  cut.remove_tets(all);
  CHECK(cut.advance(0.01).ok);
  Setup setup = box(false, 9);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<double> held(setup);
  CHECK(held.advance(0.01).ok);
  held.apply(SetMassDegree{1});
  held.apply(SetMassDegree{5});
  CHECK(held.advance(0.01).ok);
  CHECK(held.state().u.isZero(0));
}

TEST_CASE_TEMPLATE(
    "beside a region that is expanded and condensed a restored world goes on with the same bits", Real, float,
    double) {
  Setup setup = box(true, 9, 4);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() < 0.02) setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  setup.expandable = true;
  setup.gravity = {3, 0, -20};
  setup.damping = 20;
  World<Real> world(setup);
  REQUIRE(world.advance(0.02).ok);
  world.remove_tets({0, 40});
  REQUIRE(world.advance(0.02).ok);
  world.apply(SetMassDegree{3});
  world.apply(Expand{});
  REQUIRE(world.advance(0.02).ok);
  const Checkpoint<Real> kept = world.save();
  World<Real> other(setup);
  other.restore(kept);
  for (World<Real>* each : {&world, &other}) {
    each->apply(SetMassDegree{9});
    each->remove_tets({100});  // right after it was saved
    REQUIRE(each->advance(0.02).ok);
  }
  CHECK(world.state().u == other.state().u);
  CHECK(world.state().v == other.state().v);
}

TEST_CASE("what slides keeps to its plane") {
  Setup setup = box(true, 9);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.003 && setup.mesh.points(2, v) >= 0.003)
      setup.prescribed.push_back({v, Vec3d::Zero(), {true, false, false}});
  setup.gravity = {5, 0, -9.81};
  setup.damping = 10;
  World<double> world(setup);
  REQUIRE(world.advance(0.1).ok);
  bool moves = false;
  for (const PrescribedVertex& p : setup.prescribed) {
    CHECK(world.state().u(0, p.vertex) == 0);
    moves = moves || world.state().u(2, p.vertex) != 0;
  }
  CHECK(moves);
}

TEST_CASE("a degree that there is not is refused, and so are implicit steps beside one") {
  CHECK_THROWS_AS(World<double>(box(true, 17)), InputError);
  CHECK_THROWS_AS(World<double>(box(true, 0)), InputError);
  Setup setup = box(true, 5);
  World<double> world(setup);
  CHECK(world.body().inertia.degrees() == std::vector<int>{1, 3, 5});
  CHECK_THROWS_WITH_AS(world.apply(SetMassDegree{4}), doctest::Contains("no degree 4"), InputError);
  CHECK_THROWS_AS(world.apply(SetMassDegree{9}), InputError);
  CHECK(world.body().inertia.degree() == 5);
  setup.integrator = Integrator::generalised_alpha;
  CHECK_THROWS_AS(World<double>{setup}, InputError);
}
