// Worlds of materials with a Prony series: a swing and a creep of one degree of freedom against their
// equations, edits, checkpoints, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr PronyTerm fast{0.3, 0, 0.01}, slow{0.2, 0, 0.5};

// One tetrahedron, of which one vertex moves along z alone.
Setup swing(double share, double time) {
  Setup setup;
  setup.mesh.points.resize(3, 4);
  setup.mesh.points << 0, 0.01, 0, 0.002, 0, 0, 0.01, 0.003, 0, 0, 0, 0.01;
  setup.mesh.tets.resize(4, 1);
  setup.mesh.tets << 0, 1, 2, 3;
  setup.mesh.labels = {0};
  setup.materials = {seed_material};
  setup.materials[0].viscosity = {PronyTerm{share, share, time}};
  setup.material_of = {0};
  setup.region_of = {RegionModel::nonlinear};
  for (Index v = 0; v < 3; ++v) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.prescribed.push_back({3, Vec3d::Zero(), {true, true, false}});
  return setup;
}

struct Swing {  // m u″ = f − k (u + q (u − a)),  a′ = (u − a)/τ
  double k, m, q, time, force;
  std::array<double, 3> slope(const std::array<double, 3>& x) const {  // of u, u′, a
    return {x[1], (force - k * (x[0] + q * (x[0] - x[2]))) / m, (x[0] - x[2]) / time};
  }
  // u at a time, by Runge and Kutta's method.
  double at(double end, std::array<double, 3> x) const {
    const int steps = 20000;
    const double h = end / steps;
    const auto moved = [](const std::array<double, 3>& x, const std::array<double, 3>& d, double by) {
      return std::array<double, 3>{x[0] + by * d[0], x[1] + by * d[1], x[2] + by * d[2]};
    };
    for (int i = 0; i < steps; ++i) {
      const auto k1 = slope(x), k2 = slope(moved(x, k1, h / 2)), k3 = slope(moved(x, k2, h / 2)),
                 k4 = slope(moved(x, k3, h));
      for (std::size_t j = 0; j < 3; ++j) x[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    return x[0];
  }
};

// k and m of a setup like that.
Swing swing_of(const Setup& setup, double force) {
  Setup elastic = setup;
  elastic.materials[0].viscosity = {};
  constexpr double small = 1e-9;
  Mat3X<double> u = Mat3X<double>::Zero(3, 4);
  u(2, 3) = small;
  const PronyTerm& term = setup.materials[0].viscosity[0];
  World<double> world(elastic);
  const double k = -forces<double>(elastic, u)(2, 3) / small;
  return {k, world.body().inertia.mass()[3], term.shear / (1 - term.shear), term.time, force};
}

double height_after(const Setup& setup, double start, double dt, int steps) {
  Mat3X<double> u = Mat3X<double>::Zero(3, 4);
  u(2, 3) = start;
  World<double> world = world_at(setup, u);
  for (int i = 0; i < steps; ++i) world.step(dt);
  return world.state().u(2, 3);
}

// Pulled to 1.3 times its length, four layers: of no term, one, two and three.
Setup viscous_block() {
  Setup setup = setup_of(irregular_box(4));
  setup.materials.assign(4, setup.materials[0]);
  setup.materials[1].viscosity = {PronyTerm{0.25, 0.4, 0.03}};
  setup.materials[2].viscosity = {fast, slow};
  setup.materials[3].viscosity = {fast, slow, PronyTerm{0.1, 0, 20}};
  setup.materials[3].law = MaterialLaw::neo_hookean;
  setup.volume_penalty = 1e5;
  setup.ramp = 0.2;
  setup.gravity = {0, 5, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const double z = setup.mesh.points(2, v); z < 0.003 || z > 0.037)
      setup.prescribed.push_back({v, {0, 0, z < 0.003 ? 0 : 0.012}});
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[t] = std::uint16_t(std::clamp(int(100 * barycentre(setup.mesh, t).x()), 0, 3));
  return setup;
}

// A blade that falls through the middle of a box.
ScalpelSetup blade_from(double begin, double seconds = 0.06) {
  return {"blade",
          0.1,
          {{begin, {-0.01, 0.021, 0.06}}, {begin + seconds, {-0.01, 0.022, 0.012}}},
          {{0.06, 0.023, 0.062}, {0.06, 0.024, 0.008}}};
}

}  // namespace

TEST_CASE("one degree of freedom swings and creeps as its equations say, at order 2 of the step") {
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed})
    for (const double time : {3e-4, 3e-3, 3e-2}) {
      Setup setup = swing(0.5, time);
      setup.materials[0].element = element;
      Swing exact = swing_of(setup, 0);
      const double period = 2 * std::numbers::pi * std::sqrt(exact.m / exact.k), end = 3 * period;
      CAPTURE(time / period);
      const double start = 1e-8;  // [m]: small, so that it is linear
      const auto error_of_swing = [&](int steps) {
        return height_after(setup, start, end / steps, steps) - exact.at(end, {start, 0, start});
      };
      const double coarse = error_of_swing(1000), fine = error_of_swing(2000);
      CHECK(std::abs(fine) < 1e-3 * start);
      CHECK(std::log2(std::abs(coarse / fine)) == near(2, 0.05));
      setup.vertex_loads.push_back({3, Vec3d(0, 0, exact.k * start)});
      exact.force = exact.k * start;
      const double crept = height_after(setup, 0, end / 2000, 2000);
      CHECK(crept == near(exact.at(end, {0, 0, 0}), 1e-3, start));
    }
}

TEST_CASE("a load creeps from the stiffness at once to the slow one, as a standard linear solid") {
  Setup setup = swing(0.5, 0.05);
  const Swing exact = swing_of(setup, 0);
  const double reached = 1e-8, rate = std::sqrt(exact.k / exact.m);
  setup.vertex_loads.push_back({3, Vec3d(0, 0, exact.k * reached)});
  setup.damping = 2 * rate;  // it does not swing, and lags by 2/rate
  const double creep_time = 0.05 / (1 - 0.5);
  for (const double time : {8 / rate, 0.05, 0.2, 1.0}) {
    const int steps = int(time * rate / 0.2);
    const double crept = height_after(setup, 0, time / steps, steps);
    CHECK(crept == near(reached * (1 - 0.5 * std::exp(-time / creep_time)), 0.015, reached));
  }
}

TEST_CASE("a state that is set is at rest in its strain") {
  const Setup setup = viscous_block();
  Setup elastic = setup;
  for (Elastic& material : elastic.materials) material.viscosity = {};
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
  const Mat3X<double> expected = forces<double>(elastic, u);
  CHECK((forces<double>(setup, u) - expected).norm() < 1e-11 * expected.norm());
}

TEST_CASE("the step limit is that of the solid at once") {
  for (const bool is_smoothed : {false, true}) {
    Setup setup = viscous_block();
    if (is_smoothed) setup = smoothed(setup);
    Setup stiff = setup;
    for (Elastic& elastic : stiff.materials) {
      elastic = elastic.at_once();
      elastic.viscosity = {};
    }
    World<double> viscous(setup), at_once(stiff);
    CHECK(viscous.time_step_limit() == near(at_once.time_step_limit(), 1e-6));
  }
}

TEST_CASE_TEMPLATE("a restored viscous world goes on with the same bits, across cuts and threads", Real,
                   float, double) {
  for (const bool is_smoothed : {false, true}) {
    Setup setup = viscous_block();
    if (is_smoothed) setup = smoothed(setup);
    setup.scalpels.push_back(blade_from(0.05));
    World<Real> world(setup);
    for (int i = 0; i < 3; ++i) world.advance(0.02);
    world.remove_tets({0, 1, 100});
    const Checkpoint<Real> kept = world.save();
    World<Real> from_memory(setup, 2), from_bytes(setup, 3);
    from_memory.restore(kept);
    from_bytes.restore(parse_checkpoint<Real>("state", checkpoint_bytes(kept)));
    CHECK(from_memory.save().dashpots == kept.dashpots);
    for (int i = 0; i < 4; ++i) {
      for (World<Real>* each : {&world, &from_memory, &from_bytes}) CHECK(each->advance(0.02).ok);
      CHECK(same_bits(world, from_memory));
      CHECK(same_bits(world, from_bytes));
    }
    CHECK(world.elements().topology.tet_copy_count() > 0);
    CHECK(world.save().dashpots == from_bytes.save().dashpots);
    Checkpoint<Real> damaged = kept;
    damaged.dashpots.back() = std::numeric_limits<Real>::quiet_NaN();
    CHECK_THROWS_WITH_AS(from_memory.restore(damaged), doctest::Contains("dashpots"), InputError);
    damaged.dashpots.pop_back();
    CHECK_THROWS_WITH_AS(from_memory.restore(damaged), doctest::Contains("dashpots"), InputError);
  }
}

TEST_CASE("copies of cut tetrahedra have the history of what they are copies of") {
  for (const bool is_smoothed : {false, true}) {
    Setup setup = setup_of(irregular_box(4));
    setup.materials[0].viscosity = {fast, slow};
    if (is_smoothed) setup = smoothed(setup);
    const Mat3<double> F =
        Mat3<double>::Identity() + Vec3d(0.1, 0.2, -0.1) * Vec3d(0.3, 1, 2).transpose() / 5;
    setup.ramp = 0.03;
    const Mat3X<double> goal = affine_displacement(setup.mesh.points, F);
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, goal.col(v)});
    setup.scalpels.push_back(blade_from(0.0405, 1e-5));  // what it frees moves by some 1e-7 m meanwhile
    World<double> world(setup);
    const auto history = [&](double tolerance) {  // the one that all of the body has
      const std::vector<double> all = world.save().dashpots;
      for (std::size_t i = 0; i < all.size(); ++i) CHECK(all[i] == near(all[i % 12], tolerance, 0.1));
      return all;
    };
    for (int i = 0; i < 40; ++i) world.step(1e-3);
    const std::size_t before = history(1e-9).size();
    world.step(5e-4);
    const std::vector<double> uncut = history(1e-9);
    for (int i = 0; i < 12; ++i) CHECK(world.advance(1e-6).ok);
    CHECK(world.elements().topology.tet_copy_count() > 0);
    const std::vector<double> cut = history(1e-6);
    CHECK(cut.size() > before);
    for (std::size_t i = 6; i < 12; ++i) CHECK(cut[i] == near(uncut[i], 1e-3, 0.1));  // slow: half a step
  }
}

TEST_CASE("steps that are taken back leave no trace in the dashpots") {
  const Setup setup = smoothed(viscous_block());
  World<double> world(setup);
  for (int i = 0; i < 3; ++i) world.advance(0.02);
  const std::vector<double> kept = world.save().dashpots;
  world.body().regions.keep_dashpots();
  for (int i = 0; i < 3; ++i) world.step(1e-4);
  CHECK(world.save().dashpots != kept);
  world.body().regions.take_back_dashpots();
  CHECK(world.save().dashpots == kept);
  world.forces();  // looks, and lets no time pass
  world.energies();
  world.time_step_limit();
  CHECK(world.save().dashpots == kept);
}

TEST_CASE("a Prony series that is none is named") {
  const auto fault = [](const std::array<PronyTerm, most_prony_terms>& series, double nodal_pressure = 0) {
    Setup setup = setup_of(irregular_box(2));
    setup.materials[0].viscosity = series;
    setup.materials[0].nodal_pressure = nodal_pressure;
    try {
      World<double>{setup};
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(fault({fast, slow}).empty());
  CHECK(fault({PronyTerm{0.6, 0, 1}, PronyTerm{0.4, 0, 2}}).find("sum to less than 1") != std::string::npos);
  CHECK(fault({PronyTerm{0.6, 0, -1}}).find("time") != std::string::npos);
  CHECK(fault({PronyTerm{0.6, 0, 0}}).find("time") != std::string::npos);
  CHECK(fault({PronyTerm{nan, 0, 1}}).find("share") != std::string::npos);
  CHECK(fault({PronyTerm{0.6, 0, nan}}).find("time") != std::string::npos);
  CHECK(fault({fast, PronyTerm{}, slow}).find("follow each other") != std::string::npos);
  CHECK(fault({PronyTerm{0.6, 0.1, 1}}, 1).find("nodal_pressure") != std::string::npos);
}
