#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "contact/frame.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double friction = 0.3;

// A stiff block on a table, with gravity as on an incline.
World<double> on_incline(double tangent) {
  Setup setup = setup_of(box_mesh({0.02, 0.02, 0.01}, 4, 4, 2));
  setup.materials = {{4e5, 1e5, 1000}};
  const double angle = std::atan(tangent);
  setup.gravity = 9.81 * Vec3d(std::sin(angle), 0, -std::cos(angle));
  setup.damping = 15;
  setup.contact.obstacles.push_back({.name = "table", .shape = RigidShape::plane(), .friction = friction});
  return World<double>(setup);
}

double mean_x(World<double>& world) { return world.displacements().row(0).mean(); }

// After it has come to rest, or to its speed. [m/s]
double speed_on_incline(double tangent) {
  World<double> world = on_incline(tangent);
  for (int i = 0; i < 40; ++i) REQUIRE(world.advance(frame).ok);
  const double before = mean_x(world);
  for (int i = 0; i < 20; ++i) world.advance(frame);
  return (mean_x(world) - before) / (20 * frame);
}

// A strip that is held at its far end, with jaws about the near one.
Setup strip(double pull) {
  Setup setup = setup_of(box_mesh({0.03, 0.01, 0.01}, 12, 4, 4));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.0299) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 30;
  // They stand across the strip: their length along x, their width along z.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3d::UnitY()));
  const auto row = [&](double time, double x, double opening) {
    return PathPoint{time, {x, 0.005, 0.005}, turn.coeffs(), opening};
  };
  setup.probes.push_back({"jaws",
                          RigidShape::jaws({0.014, 0.004, 0.012}),
                          0.5,
                          {row(0, -0.004, 0.014), row(0.2, -0.004, 0.007), row(0.6, -0.004 - pull, 0.007)}});
  return setup;
}

}  // namespace

TEST_CASE("a block slips on an incline whose slope is the coefficient of friction, and not on one below") {
  const double creep = speed_on_incline(0.99 * friction), slip = speed_on_incline(1.01 * friction);
  MESSAGE("creep " << creep << " m/s, slip " << slip << " m/s");
  CHECK(std::abs(creep) < 1e-6);
  const double expected = 9.81 * std::cos(std::atan(friction)) * 0.01 * friction / 15;  // against its damping
  CHECK(slip > 0.3 * expected);
  CHECK(slip < 1.1 * expected);
}

TEST_CASE("jaws hold by friction, and slip when they pull too hard") {
  // By how much the near end follows once the jaws have closed.
  const auto follows = [](double pull, double& pulled, double& grip) {
    World<float> world(strip(pull));
    const auto end = [&] {
      double sum = 0;
      int count = 0;
      for (Index v = 0; v < world.elements().topology.vertex_count(); ++v) {
        if (world.elements().points.col(v).x() > 1e-6) continue;
        sum -= double(world.displacements()(0, v));
        ++count;
      }
      return sum / count;
    };
    for (int i = 0; i < 10; ++i) REQUIRE(world.advance(frame).ok);
    const double closed = end();
    for (int i = 10; i < 45; ++i) REQUIRE(world.advance(frame).ok);
    pulled = -world.tools().lists().probes.front().force.x();
    grip = world.tools().lists().probes.front().grip;
    return end() - closed;
  };
  double pulled, grip;
  const double held = follows(0.001, pulled, grip);
  CHECK(grip > 0.05);
  CHECK(pulled > 0);
  CHECK(pulled < 2 * 0.5 * grip * 1.001);
  CHECK(held == near(0.001, 0.25));
  const double slipped = follows(0.02, pulled, grip);
  MESSAGE("followed by " << held << " of 1 mm and " << slipped << " of 20 mm");
  CHECK(slipped < 0.008);
}

TEST_CASE("jaws of hands close until they feel what is between them, and keep it") {
  Setup setup = strip(0);
  setup.probes.clear();
  setup.materials = {{4e5, 1e5, 1000}};
  World<float> world(setup);
  ToolPose pose{{-0.004, 0.005, 0.005},
                Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3d::UnitY())).coeffs(),
                0.016};
  world.apply(BringProbe{"jaws", RigidShape::jaws({0.014, 0.004, 0.012}), pose, 0.5});
  world.apply(SwitchTool{1, true});
  for (int i = 0; i < 60; ++i) REQUIRE(world.advance(frame).ok);
  const auto jaws = [&]() -> const Probe& { return world.tools().lists().probes.front(); };
  CHECK(jaws().path.back().opening < 0.01);
  CHECK(jaws().grip > 0.1);
  world.apply(SwitchTool{1, false});
  for (int i = 0; i < 60; ++i) world.advance(frame);
  CHECK(jaws().path.back().opening == near(0.016, 1e-9));
  CHECK(jaws().grip == 0);
}
