#include "lobe/contact/contact.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "condense/half_linear.h"
#include "contact/frame.h"
#include "lobe/contact/quadrature.h"
#include "lobe/error.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr ToolId probe = 1;

const Probe& first_probe(const Tools& tools) { return tools.lists().probes.front(); }

// A block whose top is pressed by a probe, held at the bottom.
Setup pressed_block(RegionModel model = RegionModel::nonlinear) {
  Setup setup = setup_of(irregular_box(5), model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 15;
  return setup;
}

ProbeSetup ball(double radius, std::vector<PathPoint> path, double friction = 0) {
  return {"ball", RigidShape::sphere(radius), friction, std::move(path)};
}

// ---- A rigid sphere on an elastic half space

struct Hertz {
  static constexpr double radius = 0.01, depth = 0.0004, size = 0.05;  // [m]
  static constexpr double young = 2e4, poisson = 0.3;
};

// The force over Hertz'. A quarter of a block, whose cells are finest where it is pressed. With 0.88 s³ they
// would be coarser at the rim of the contact, and the mesh alone too stiff by 8 %.
double press_half_space(int n) {
  TetMesh mesh = box_mesh(Vec3d::Constant(1), n, n, n);
  for (double& s : mesh.points.reshaped()) s = Hertz::size * (0.12 * s + 0.88 * std::pow(s, 5));
  mesh.points.row(2) *= -1;
  mesh.tets.row(0).swap(mesh.tets.row(1));
  Setup setup = setup_of(mesh, RegionModel::tensor_mass);
  const double young = Hertz::young, poisson = Hertz::poisson;
  setup.materials = {
      {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson)), 1000}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d x = setup.mesh.points.col(v);
    const Axes axes{x[0] == 0, x[1] == 0, false};
    if (x[2] < -0.999 * Hertz::size)
      setup.prescribed.push_back({v, Vec3d::Zero()});
    else if (axes[0] || axes[1])
      setup.prescribed.push_back({v, Vec3d::Zero(), axes});
  }
  setup.damping = 120;
  setup.probes.push_back(
      ball(Hertz::radius, {{0, {0, 0, Hertz::radius}}, {0.1, {0, 0, Hertz::radius - Hertz::depth}}}));
  World<float> world(setup, 2);
  for (int i = 0; i < 14; ++i) REQUIRE(world.advance(frame).ok);
  const double modulus = young / (1 - poisson * poisson);
  const double hertz = 4.0 / 3 * modulus * std::sqrt(Hertz::radius) * std::pow(Hertz::depth, 1.5);
  return -4 * first_probe(world.tools()).force.z() / hertz;
}

// The block is no half space, but a layer that is fixed below. By how much that is stiffer is a series in
// χ = √(R δ)/h (Dimitriadis et al., Biophysical Journal 82, 2002, equation 11): 1.036 here.
double of_a_layer() {
  constexpr double pi = EIGEN_PI, nu = Hertz::poisson;
  const double chi = std::sqrt(Hertz::radius * Hertz::depth) / Hertz::size;
  const double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  return 1 - 2 * a / pi * chi + 4 * a * a / (pi * pi) * chi * chi -
         8 / std::pow(pi, 3) * (a * a * a + 4 * pi * pi / 15 * b) * chi * chi * chi;
}

}  // namespace

TEST_CASE("a sphere that is pressed on a half space feels Hertz' force") {
  const double coarse = press_half_space(10), middle = press_half_space(14), fine = press_half_space(20);
  MESSAGE("force over Hertz': " << coarse << ", " << middle << ", " << fine << "; of a layer "
                                << of_a_layer());
  CHECK(fine == near(1, 0.05));
  CHECK(fine == near(of_a_layer(), 0.015));
  CHECK(std::abs(fine - of_a_layer()) < std::abs(middle - of_a_layer()));
  CHECK(std::abs(middle - of_a_layer()) < std::abs(coarse - of_a_layer()));
}

TEST_CASE("contact forces are minus the slope of the energy, and its stiffness is what vertices feel") {
  Setup setup = pressed_block();
  setup.contact.damping = 0;
  setup.probes.push_back({"tip", RigidShape::capsule(0.012, 0.03), 0, {{0, {0.025, 0.022, 0.060}}}});
  World<double> world(setup);
  world.step(1e-9);
  State<double> state = world.state();
  state.u = random_displacement<double>(static_cast<Index>(state.u.cols()), 5e-4);
  world.set_state(state);
  const auto& term = world.body().terms.front();
  Mat3X<double> f = Mat3X<double>::Zero(3, state.u.cols());
  term->add_forces(world.body().here(), f);
  DiagonalStiffness K = DiagonalStiffness::Zero(6, state.u.cols());
  term->add_diagonal_stiffness(world.body().here(), K);
  REQUIRE(f.norm() > 1e-3);
  const double h = 1e-8;  // [m]
  const auto energy_at = [&](Index v, int axis, double move) {
    State<double> moved = state;
    moved.u(axis, v) += move;
    world.set_state(moved);
    return term->energy(world.body().here());
  };
  const auto force_at = [&](Index v, int axis, double move) {
    State<double> moved = state;
    moved.u(axis, v) += move;
    world.set_state(moved);
    Mat3X<double> there = Mat3X<double>::Zero(3, state.u.cols());
    term->add_forces(world.body().here(), there);
    return there(axis, v);
  };
  double stiffest = 0;
  for (Index v = 0; v < state.u.cols(); ++v) stiffest = std::max(stiffest, K.col(v).maxCoeff());
  for (Index v = 0; v < state.u.cols(); ++v) {
    if (f.col(v).norm() == 0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = (energy_at(v, axis, h) - energy_at(v, axis, -h)) / (2 * h);
      CHECK(f(axis, v) == near(-slope, 1e-5, f.norm()));
    }
    // A curved tool turns the force as well, which lowers the stiffness.
    const double felt = -(force_at(v, 2, h) - force_at(v, 2, -h)) / (2 * h);
    CHECK(felt < K(5, v) * 1.001 + 1e-6 * stiffest);
    CHECK(felt > 0.6 * K(5, v) - 0.02 * stiffest);
  }
}

// Against all points of all triangles. Without friction and with lumped masses nothing is remembered.
TEST_CASE("what a tip touches is found among all points, however small it is") {
  for (double radius : {0.0008, 0.003, 0.012}) {
    Setup setup = setup_of(box_mesh(Vec3d::Constant(0.05), 5, 5, 5), RegionModel::nonlinear);
    const Vec3d centre(0.0243, 0.0227, 0.05 + 0.8 * radius);
    setup.probes.push_back(ball(radius, {{0, centre}}));
    World<double> world(setup);
    world.advance(1e-4);
    const auto& contact = dynamic_cast<const Contact<double>&>(*world.body().terms.front());
    const Mat3X<double> x = setup.mesh.points + world.state().u;
    double energy = 0;
    int touched = 0;
    for (const ContactSurface::Triangle& triangle : contact.surface().triangles()) {
      Mat3<double> corners;
      for (int c = 0; c < 3; ++c)
        corners.col(c) = x.col(contact.surface().points()[std::size_t(triangle.points[c])].corners[0]);
      const int n = std::clamp(static_cast<int>(std::ceil(triangle.longest / (radius / 2))), 2, 24);
      visit_centroids(n, [&](int, const Vec3d& weights) {
        const double depth = radius - (corners * weights - centre).norm();
        if (depth <= 0) return;
        energy += triangle.area / (n * n) * triangle.stiffness * depth * depth / 2;
        ++touched;
      });
    }
    CHECK(touched > 1);
    CHECK(world.energies().applied == near(energy, 1e-9));
  }
}

TEST_CASE("what a tool gives a free body in momentum is what it feels") {
  Setup setup = setup_of(irregular_box(4));
  setup.probes.push_back(
      {"plate",
       RigidShape::box({0.02, 0.03, 0.01}),
       0.2,
       {{0, {0.03, 0.025, 0.047}}, {0.1, {0.032, 0.025, 0.039}, {0, 0.1, 0, std::sqrt(0.99)}}}});
  World<float> world(setup);
  Vec3d given = Vec3d::Zero(), spun = Vec3d::Zero();
  for (int i = 0; i < 10; ++i) {
    const double step = world.time_step_limit() * 0.8;
    for (int k = 0; k < 20; ++k) {
      const Vec3d at = path_at(setup.probes[0].path, world.time());
      const double kick = world.state().velocity_lag + step / 2;  // for which velocities feel the force
      REQUIRE(world.step(step));
      given += kick * first_probe(world.tools()).force;
      spun += kick * (first_probe(world.tools()).torque + at.cross(first_probe(world.tools()).force));
    }
  }
  Vec3d momentum = Vec3d::Zero(), angular = Vec3d::Zero();
  const StateView<float> state = world.state();
  for (Index v = 0; v < state.u.cols(); ++v) {
    const double m = world.body().inertia.mass()[std::size_t(v)];
    const Vec3d x = world.elements().points.col(v) + state.u.col(v).cast<double>();
    momentum += m * state.v.col(v).cast<double>();
    angular += m * x.cross(state.v.col(v).cast<double>());
  }
  REQUIRE(given.norm() > 1e-4);
  CHECK((momentum - given).norm() < 1e-6 * given.norm());
  CHECK((angular - spun).norm() < 1e-5 * spun.norm());
}

// A step that takes a point from a outside to b inside loses ½ κ A a b of the energy, and one that takes it
// out again gains as much on average: without damping energy walks at random. The law's own damping outweighs
// that.
TEST_CASE("a body that bounces gains no energy in 100,000 steps at 0.9 of the limit") {
  // Linear, since its limit is then that of all that it does.
  Setup setup = setup_of(irregular_box(2, 0.01), RegionModel::tensor_mass);
  setup.gravity = {0, 0, -9.81};
  setup.probes.push_back({"table", RigidShape::box({1, 1, 0.1}), 0, {{0, {0, 0, -0.0535}}}});
  World<double> world(setup);
  const double dt = 0.9 * world.time_step_limit();
  world.step(dt);
  const double start = staggered_energy(world, dt);
  double largest = -1, lowest = 0, highest = -1, now = 0;
  for (int i = 0; i < 100'000; ++i) {
    now = staggered_energy(world, dt) - start;
    largest = std::max(largest, now);
    const double height = world.state().u.row(2).mean();
    lowest = std::min(lowest, height);
    if (lowest < -0.0035) highest = std::max(highest, height);  // once it has fallen
  }
  // What it falls by is the energy that there is to lose or gain.
  double weight = 0;
  for (double m : world.body().inertia.mass()) weight += 9.81 * m;
  const double fallen = -lowest * weight;
  MESSAGE("energy " << now / fallen << " at the end, at most " << largest / fallen
                    << " of what it falls through; it falls by " << lowest << " m, rises to " << highest);
  CHECK(largest < 1e-3 * fallen);
  CHECK(now > -fallen);
  CHECK(lowest > -0.005);  // the lowest vertex begins at most 5.5 mm above the table
  CHECK(highest > lowest / 2);
}

TEST_CASE("friction: bits are the same on any threads, from a checkpoint, by hand and in a replay") {
  const auto lead = [](auto& world, int i) {
    if (i == 0)
      world.apply(BringProbe{"finger", RigidShape::capsule(0.008, 0.05), {{0.025, 0.02, 0.060}}, 0.3});
    if (i > 0 && i < 14) world.apply(Lead{probe, {{0.025, 0.02 + 0.0006 * i, 0.060 - 0.0007 * i}}});
    if (i == 18) world.apply(LetGo{probe});
  };
  const Setup setup = pressed_block();
  World<float> one(setup), two(setup, 2), seven(setup, 7);
  CommandRecorder<float> recorded(one);
  Checkpoint<float> middle;
  double most = 0;
  for (int i = 0; i < 22; ++i) {
    lead(recorded, i);
    lead(two, i);
    lead(seven, i);
    REQUIRE(recorded.advance(frame).ok);
    two.advance(frame);
    seven.advance(frame);
    most = std::max(most, first_probe(one.tools()).force.norm());
    if (i == 9) middle = one.save();
  }
  CHECK(most > 0.01);
  CHECK(first_probe(one.tools()).has_gone());
  CHECK(same_bits(one, two));
  CHECK(same_bits(one, seven));

  World<float> restored(setup, 2);
  restored.restore(middle);
  for (int i = 10; i < 22; ++i) {
    lead(restored, i);
    restored.advance(frame);
  }
  CHECK(same_bits(one, restored));

  World<float> again(setup);
  CHECK_NOTHROW(replay(recorded.recording(), again));
  CHECK(same_bits(one, again));

  Setup kept = setup;
  static_cast<ToolSetups&>(kept) = one.tools().paths();
  REQUIRE(kept.probes.size() == 1);
  World<float> by_path(kept);
  for (int i = 0; i < 22; ++i) by_path.advance(frame);
  CHECK(same_bits(one, by_path));
}

TEST_CASE("a probe that is far away changes nothing, and a body without contact has no term for it") {
  Setup setup = pressed_block();
  setup.gravity = {0, 0, -9.81};
  World<float> alone(setup);
  setup.probes.push_back(ball(0.005, {{0, {0.2, 0.2, 0.2}}, {0.4, {0.25, 0.2, 0.2}}}, 0.1));
  World<float> beside(setup);
  for (int i = 0; i < 10; ++i) {
    alone.advance(frame);
    beside.advance(frame);
  }
  CHECK(same_bits(alone, beside));
  CHECK(first_probe(beside.tools()).force.norm() == 0);
  CHECK(alone.body().terms.empty());
  CHECK(beside.body().terms.size() == 1);
}

TEST_CASE("a probe that is inside at the start, teleports or spins is survived or reported") {
  for (const double friction : {0.0, 0.3}) {
    const std::vector<std::vector<PathPoint>> paths{
        {{0, {0.025, 0.025, 0.048}}},  // deep in the skin
        {{0, {0.025, 0.025, 0.025}}},  // in the middle
        {{0, {0.025, 0.025, 0.2}}, {0.1, {0.025, 0.025, 0.2}}, {0.101, {0.025, 0.025, 0.045}}},
        {{0, {0.025, 0.025, 0.055}, {0, 0, 0, 1}},
         {0.05, {0.025, 0.025, 0.055}, {0, 0, 1, 0}},
         {0.1, {0.025, 0.025, 0.055}, {0, 0, 0, -1}}}};
    for (const std::vector<PathPoint>& path : paths) {
      Setup setup = pressed_block();
      setup.probes.push_back(ball(0.008, path, friction));
      World<float> world(setup);
      for (int i = 0; i < 20; ++i) {
        const Report report = world.advance(frame);
        CHECK((report.ok || !report.conditions.empty()));
        CHECK(world.state().u.allFinite());
      }
    }
  }
}

TEST_CASE("a probe that begins wholly inside feels nothing") {
  Setup setup = pressed_block();
  setup.probes.push_back(ball(0.008, {{0, {0.025, 0.025, 0.025}}}));
  World<float> world(setup);
  for (int i = 0; i < 10; ++i) {
    REQUIRE(world.advance(frame).ok);
    CHECK(first_probe(world.tools()).force.norm() == 0);
  }
}

// A plate that lies over all of the top, two cells deep in the block. Beyond a depth of a quarter of the mean
// edge the pressure grows no more.
TEST_CASE("a probe that begins across the surface pushes with the highest pressure, wherever it is deeper") {
  constexpr double height = 0.05, deep = 0.02, instant = 1e-5;
  Setup setup = pressed_block();
  setup.probes.push_back(
      {"plate", RigidShape::box({0.3, 0.3, 0.2}), 0, {{0, {0.025, 0.025, height - deep + 0.1}}}});
  World<float> world(setup);
  REQUIRE(world.advance(instant).ok);
  const ContactSurface& surface = dynamic_cast<const Contact<float>&>(*world.body().terms.front()).surface();
  const double deepest = deepest_contact * surface.mean_edge();
  double least = 0, most = 0;  // [N]
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    double lowest = height, highest = 0;
    for (const int p : triangle.points) {
      const double z = setup.mesh.points(2, surface.points()[std::size_t(p)].corners[0]);
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
    }
    const double force = triangle.stiffness * triangle.area * deepest;
    if (lowest > height - deep + deepest) least += force;
    if (highest > height - deep) most += force;
  }
  const double force = std::abs(first_probe(world.tools()).force.z());
  MESSAGE("force " << force << " N, from " << least << " to " << most << " N");
  CHECK(deep > 4 * deepest);
  CHECK(most < 3 * least);
  CHECK(force > 0.99 * least);
  CHECK(force < most);
}

TEST_CASE("a probe that cannot be is refused by its name") {
  World<float> world(pressed_block());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ToolPose there{{0, 0, 0.2}};
  const auto refuses = [&](const BringProbe& command, const char* what) {
    CHECK_THROWS_WITH_AS(world.apply(command), what, InputError);
  };
  refuses({"tip", RigidShape::sphere(0), there}, "probe: it needs a radius above 0 m, and finite");
  refuses({"tip", RigidShape::box({0.1, -1, 0.1}), there}, "probe: it needs edges above 0 m, and finite");
  refuses({"tip", RigidShape::sphere(0.01), there, -0.1},
          "probe: needs a friction of at least 0, and finite");
  refuses({"tip", RigidShape::sphere(0.01), {{0, nan, 0}}},
          "probe: needs a finite position and a unit quaternion for its orientation");
  CHECK(world.tools().lists().probes.empty());
  world.apply(BringProbe{"tip", RigidShape::sphere(0.01), there});
  CHECK_THROWS_AS(world.apply(Lead{probe, {{nan, 0, 0}}}), InputError);
  CHECK(world.advance(frame).ok);

  Setup setup = pressed_block();
  setup.probes.push_back(ball(-1, {{0, Vec3d::Zero()}}));
  CHECK_THROWS_WITH_AS(World<float>{setup}, "setup: probe \"ball\" needs a radius above 0 m, and finite",
                       InputError);
  setup.probes.back() = ball(0.01, {{0, Vec3d::Zero()}}, -0.5);
  CHECK_THROWS_WITH_AS(World<float>{setup},
                       "setup: probe \"ball\" needs a friction of at least 0, and finite", InputError);
}
