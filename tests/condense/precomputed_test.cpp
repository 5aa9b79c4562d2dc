#include "lobe/condense/precomputed.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "condense/half_linear.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "lobe/solve/tangent.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// K of the precomputed tetrahedra, dense, 3 × vertex + axis.
Eigen::MatrixXd dense_stiffness(const Elements& elements) {
  const Eigen::Index n = 3 * elements.topology.vertex_count();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (elements.region_of[t] != RegionModel::precomputed || !elements.topology.alive(t)) continue;
    const TetStiffness stiffness = tet_stiffness(elements, t, Mat34<double>::Zero());
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        K(3 * corners[i / 3] + i % 3, 3 * corners[j / 3] + j % 3) += stiffness(i, j);
  }
  return K;
}

}  // namespace

TEST_CASE("the condensed hybrid is in equilibrium where the static solution of the same hybrid is") {
  Setup setup = half_linear(RegionModel::precomputed);
  load(setup);
  StaticOptions options;
  options.tolerance = 1e-13;
  const StaticResult exact = solve_static(setup, options);
  REQUIRE(exact.converged);
  World<double> world(setup);
  State<double> state = world.state();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (world.body().inertia.mass()[v] > 0) state.u.col(v) = exact.u.col(v);
  world.set_state(state);
  const double weight = 9.81 * 1000 * 0.05 * 0.05 * 0.05;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (!world.held().holds(v)) CHECK(world.forces().col(v).norm() < 1e-10 * weight);
  CHECK((world.state().u - exact.u).norm() < 1e-10 * exact.u.norm());
  CHECK(world.energies().elastic_linear + world.energies().elastic_nonlinear == near(exact.energy, 1e-9));
}

TEST_CASE("a region without interface is the linear static solution, with prescribed displacements") {
  Setup setup = half_linear(RegionModel::precomputed);
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::precomputed);
  load(setup);
  setup.load_ramp = 0.5;
  const double end = setup.mesh.points.row(0).maxCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > end - 0.004)
      setup.prescribed.push_back({v, {0.004, 0, 0.002}, v % 2 ? all_axes : Axes{true, false, true}});
  World<double> world(setup);
  for (int i = 0; i < 3; ++i) REQUIRE(world.advance(0.2).ok);
  const StaticResult exact = solve_static(setup);
  CHECK((world.state().u - exact.u).norm() < 1e-10 * exact.u.norm());
  Vec3d loads = Vec3d::Zero();
  for (const VertexLoad& l : setup.vertex_loads) loads += l.force;
  double mass = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) mass += lumped_mass(world.elements(), v);
  CHECK((world.body().reaction(HeldVertices::boundary) + loads + mass * setup.gravity).norm() <
        1e-9 * mass * setup.gravity.norm());
}

TEST_CASE("the force on the interface is that of a dense Schur complement") {
  const Setup setup = half_linear(RegionModel::precomputed);
  World<double> world(setup);
  world.set_state(random_state(world, 1e-3));
  const Mat3X<double> u = world.state().u, f = world.forces();
  Setup without = setup;
  std::fill(without.region_of.begin(), without.region_of.end(), RegionModel::nonlinear);
  for (std::size_t t = 0; t < setup.region_of.size(); ++t)
    if (setup.region_of[t] == RegionModel::precomputed) without.region_of[t] = RegionModel::tensor_mass;
  World<double> tensor_mass(without);
  tensor_mass.set_state(world.state());
  // The interior is in equilibrium, so that the tensor-mass forces of the same field are those of S.
  const Eigen::MatrixXd K = dense_stiffness(world.elements());
  std::vector<Index> interior, interface;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const auto around = world.elements().topology.around(v);
      const auto in_region = [&](Index t) { return setup.region_of[t] == RegionModel::precomputed; };
      if (std::none_of(around.begin(), around.end(), in_region)) continue;
      bool fixed = false;
      for (const HeldVertices::Held& item : world.held().all()) fixed |= item.vertex == v && item.axes[axis];
      if (fixed) continue;
      if (!std::all_of(around.begin(), around.end(), in_region))
        interface.push_back(3 * v + axis);
      else
        interior.push_back(3 * v + axis);
    }
  const Eigen::MatrixXd K_bi = K(interface, interior);
  const Eigen::MatrixXd S = K(interface, interface) -
                            K_bi * Eigen::LLT<Eigen::MatrixXd>(K(interior, interior)).solve(K_bi.transpose());
  const Eigen::VectorXd expected = -S * u.reshaped()(interface);
  PrecomputedRegion<double> region;
  RegionEdit everything;
  everything.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(everything.entered.begin(), everything.entered.end(), 0);
  everything.vertices.resize(std::size_t(setup.mesh.vertex_count()));
  std::iota(everything.vertices.begin(), everything.vertices.end(), 0);
  Mat3X<double> none = Mat3X<double>::Zero(3, u.cols()), force = none, dead = none;
  REQUIRE(region.follow(world.elements(), world.held(), everything, none, dead).empty());
  Parallel two_threads(2);
  region.add_forces(u, 0, force, two_threads);
  CHECK((force.reshaped()(interface) - expected).norm() < 1e-12 * expected.norm());
  CHECK(region.interface_size() == static_cast<Index>(interface.size()));
  CHECK((f - tensor_mass.forces()).reshaped()(interface).norm() < 1e-11 * f.norm());
  CHECK(world.energies().elastic_linear == near(-expected.dot(u.reshaped()(interface)) / 2, 1e-11));
}

TEST_CASE("single precision follows double") {
  Setup setup = half_linear(RegionModel::precomputed);
  load(setup);
  World<double> exact(setup);
  World<float> world(setup);
  exact.set_state(random_state(exact, 1e-3));
  State<float> state = world.state();
  state.u = exact.state().u.cast<float>();
  world.set_state(state);
  CHECK((world.forces().cast<double>() - exact.forces()).norm() < 2e-6 * exact.forces().norm());
  CHECK((world.state().u.cast<double>() - exact.state().u).norm() < 1e-5 * exact.state().u.norm());
}

TEST_CASE("the interface bears the mass of what follows it") {
  World<double> world(half_linear(RegionModel::precomputed, 4));
  const Eigen::MatrixXd K = dense_stiffness(world.elements());
  std::vector<Index> inside, shared;
  for (Index i = 0; i < static_cast<Index>(K.rows()); ++i) {
    const auto around = world.elements().topology.around(i / 3);
    const auto is_linear = [&](Index t) { return world.elements().region_of[t] == RegionModel::precomputed; };
    const bool held = world.held().holds(i / 3) && K(i, i) > 0 && [&] {
      for (const HeldVertices::Held& item : world.held().all())
        if (item.vertex == i / 3 && item.axes[i % 3]) return true;
      return false;
    }();
    if (held || std::none_of(around.begin(), around.end(), is_linear)) continue;
    (std::all_of(around.begin(), around.end(), is_linear) ? inside : shared).push_back(i);
  }
  double bears = 0, expected = 0;
  for (Index i : shared)
    bears += (world.body().inertia.mass()[i / 3] - lumped_mass(world.elements(), i / 3)) / 3;
  // Kinetic energy of the interior at unit velocity of the interface along each axis, twice: a third of all
  // three.
  const Eigen::LDLT<Eigen::MatrixXd> interior(K(inside, inside));
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(Eigen::Index(shared.size()));
    for (std::size_t i = 0; i < shared.size(); ++i) unit[Eigen::Index(i)] = shared[i] % 3 == axis;
    const Eigen::VectorXd follows = -interior.solve(K(inside, shared) * unit);
    for (std::size_t i = 0; i < inside.size(); ++i)
      expected += lumped_mass(world.elements(), inside[i] / 3) * follows[Eigen::Index(i)] *
                  follows[Eigen::Index(i)] / 3;
  }
  CHECK(bears == near(expected, 1e-9));
  CHECK(expected > 0);
}

TEST_CASE("an undamped hybrid keeps its energy") {
  World<double> world(half_linear(RegionModel::precomputed, 4));
  world.set_state(random_state(world, 2e-4));
  const double energy = world.energies().total(), dt = 0.05 * world.time_step_limit();
  double lowest = energy, highest = energy;
  for (int i = 0; i < 2000; ++i) {
    world.step(dt);
    lowest = std::min(lowest, world.energies().total());
    highest = std::max(highest, world.energies().total());
  }
  CHECK(highest < 1.05 * energy);
  CHECK(lowest > 0.95 * energy);
}

TEST_CASE("cuts and changes of region leave what would be condensed afresh") {
  for (int batch : {1, 9, 60}) {
    CAPTURE(batch);
    Setup setup = half_linear(RegionModel::precomputed, 4);
    load(setup);
    World<double> world(setup);
    world.set_state(random_state(world, 1e-3));
    const Index tets = setup.mesh.tet_count();
    std::vector<Index> order(std::size_t(tets), 0);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    Index removed = 0;
    for (Index i = 0; i < tets; i += batch) {
      const std::vector<Index> now(order.begin() + i, order.begin() + std::min(tets, i + batch));
      removed += world.remove_tets(now);
      const RebuildDifference d = compare_with_rebuilt(world);
      CAPTURE(i);
      CHECK(d.mass < 1e-9);
      CHECK(d.force < 1e-9);
      CHECK(d.interior < 1e-9);
      CHECK(d.frequency < 1e-9);
      CHECK(d.largest() < 1e-9);
    }
    CHECK(removed == tets);
    CHECK(world.forces().norm() == 0);
  }
}

TEST_CASE("tetrahedra enter and leave the region where they are") {
  Setup setup = half_linear(RegionModel::precomputed, 4);
  load(setup);
  World<double> world(setup);
  world.set_state(random_state(world, 1e-4));
  std::vector<Index> inner, scattered;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    if (std::abs(barycentre(setup.mesh, t).x() - 0.02) < 0.008) inner.push_back(t);
    if (t % 11 == 0) scattered.push_back(t);
  }
  const auto move = [&](const std::vector<Index>& tets, RegionModel model) {
    const Mat3X<double> before = world.state().u;
    world.apply(SetRegion{tets, model});
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (world.body().inertia.mass()[v] > 0)
        CHECK((world.state().u.col(v) - before.col(v)).norm() < 1e-12 * before.norm());
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  };
  move(inner, RegionModel::nonlinear);
  move(inner, RegionModel::precomputed);
  move(scattered, RegionModel::tensor_mass);
  move(inner, RegionModel::tensor_mass);
  move(inner, RegionModel::precomputed);
  CHECK_THROWS_WITH_AS(world.apply(SetRegion{{setup.mesh.tet_count() - 1}, RegionModel::precomputed}),
                       doctest::Contains("without enough fixed vertices"), InputError);
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE(
    "a grasp inside the region leads it to the static solution, feels it, and lets it go without a trace") {
  Setup setup = half_linear(RegionModel::precomputed);
  const auto never_held = setup.prescribed;
  GraspSetup grasp{"grasper", {}, {{0.1, {0, 0, 0}}, {0.4, {0.001, 0.002, 0}}}, true};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (std::abs(setup.mesh.points(0, v) - 0.01) < 0.003 && setup.mesh.points(2, v) > 0.035)
      grasp.vertices.push_back(v);
  REQUIRE(grasp.vertices.size() > 4);
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::precomputed);
  Setup led = setup;
  for (Index v : grasp.vertices) led.prescribed.push_back({v, {0.001, 0.002, 0}});
  const StaticResult exact = solve_static(led);
  setup.grasps = {grasp};
  World<double> world(setup);
  const auto u_at = [&](double time) {
    while (world.time() < time - 1e-6) REQUIRE(world.advance(0.05).ok);
    return world.state().u;
  };
  CHECK(u_at(0.1).norm() == 0);
  const Mat3X<double> half = u_at(0.25);
  CHECK((half - exact.u / 2).norm() < 1e-10 * exact.u.norm());
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  CHECK((world.body().reaction(1) + world.body().reaction(HeldVertices::boundary)).norm() <
        1e-9 * world.body().reaction(1).norm());
  CHECK(world.body().reaction(1).dot(Vec3d(0.001, 0.002, 0)) / 2 ==
        near(2 * world.energies().elastic_linear, 1e-9));
  CHECK(u_at(0.5).norm() < 1e-12 * exact.u.norm());
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE("a cautery through both regions cuts the same on one, two and seven threads, and leaves no trace") {
  Setup setup = half_linear(RegionModel::precomputed, 8);
  load(setup);
  setup.damping = 20;
  setup.cauteries.push_back({"bipolar", 0.009, {{0, {0.02, -0.02, 0.08}}, {0.2, {0.065, 0.1, 0.03}}}});
  World<float> first(setup, 1), second(setup, 2), seventh(setup, 7);
  Index removed = 0;
  for (int i = 0; i < 8; ++i) {
    const Report report = first.advance(0.03);
    REQUIRE(report.ok);
    removed += report.tets_removed;
    second.advance(0.03);
    seventh.advance(0.03);
    REQUIRE(first.state().u == second.state().u);
    REQUIRE(first.state().u == seventh.state().u);
  }
  CHECK(removed > 100);
  World<double> exact(setup);
  for (int i = 0; i < 8; ++i) REQUIRE(exact.advance(0.03).ok);
  CHECK(compare_with_rebuilt(exact).largest() < 1e-9);
  CHECK((first.state().u.cast<double>() - exact.state().u).norm() < 1e-3 * exact.state().u.norm());
}

TEST_CASE("a checkpoint of cuts and grasps in the region goes on with the same bits") {
  Setup setup = half_linear(RegionModel::precomputed);
  load(setup);
  setup.cauteries.push_back({"bipolar", 0.006, {{0, {0.015, -0.01, 0.05}}, {0.1, {0.03, 0.06, 0.03}}}});
  setup.grasps.push_back({"grasper", {14, 50, 51, 52}, {{0.03, {0, 0, 0}}, {0.1, {0.001, 0, 0}}}, true});
  World<float> first(setup), second(setup);
  for (int i = 0; i < 4; ++i) REQUIRE(first.advance(0.02).ok);
  second.restore(first.save());
  for (int i = 0; i < 4; ++i) {
    first.advance(0.02);
    second.advance(0.02);
    CHECK(first.state().u == second.state().u);
  }
  CHECK(first.journal().edits.size() > 4);
}

TEST_CASE("an interface too large for memory is refused before anything is allocated") {
  Setup setup = setup_of(box_mesh({0.6, 0.6, 0.02}, 60, 60, 2));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() < 0.01) setup.region_of[t] = RegionModel::precomputed;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  CHECK_THROWS_WITH_AS(World<float>{setup}, doctest::Contains("3721 vertices would take 10966 MB"),
                       InputError);
}
