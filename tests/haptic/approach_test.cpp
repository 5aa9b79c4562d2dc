// Where a tool that feels nothing will touch.
#include "lobe/haptic/approach.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double height = 0.05;  // of a block with flat faces [m]

Setup flat_block() { return setup_of(box_mesh({0.05, 0.05, height}, 5, 5, 5)); }

}  // namespace

TEST_CASE("a tool before a flat face knows how far it has to go, and against which normal") {
  World<double> world(flat_block());
  constexpr double radius = 0.008, gap = 0.003;
  const ToolPose before{.position = {0.025, 0.024, height + radius + gap}};
  const auto ball = approach_of(world, RigidShape::sphere(radius), 0, before, 0.01);
  REQUIRE(ball);
  // Contact is looked for at points. None of the face is farther from one than a third of the radius.
  CHECK(ball->gap >= gap - 1e-12);
  CHECK(ball->gap < gap + radius / 18);
  CHECK(ball->normal.z() > 0.94);
  // A box meets the face all over, and a capsule that lies on its side along a line.
  const auto box = approach_of(world, RigidShape::box({0.01, 0.02, 2 * radius}), 0, before, 0.01);
  REQUIRE(box);
  CHECK(box->gap == near(gap, 1e-9));
  CHECK((box->normal - Vec3d::UnitZ()).norm() < 1e-9);
  const Eigen::Quaterniond lying(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3d::UnitX()));
  const auto capsule = approach_of(world, RigidShape::capsule(radius, 0.01), 0,
                                   {.position = before.position, .orientation = lying.coeffs()}, 0.01);
  REQUIRE(capsule);
  CHECK(capsule->gap >= gap - 1e-12);
  CHECK(capsule->gap < gap + radius / 18);
}

TEST_CASE("a tool that is in the body already has a gap below 0; far from it there is none") {
  World<float> world(flat_block());
  constexpr double radius = 0.008;
  const auto at = [&](double above, double reach) {
    return approach_of(world, RigidShape::sphere(radius), 0, {.position = {0.025, 0.024, height + above}},
                       reach);
  };
  const auto inside = at(radius - 0.001, 0.01);
  REQUIRE(inside);
  CHECK(inside->gap < 0);
  CHECK(inside->gap == near(-0.001, 0.5));
  CHECK_FALSE(at(radius + 0.011, 0.01));
  CHECK(at(radius + 0.009, 0.01));
}

TEST_CASE("jaws meet a face with their tips, or what is between them with the nearer jaw") {
  World<double> world(flat_block());
  const Vec3d size(0.01, 0.004, 0.02);  // they go from their position upwards along z
  const auto above =
      approach_of(world, RigidShape::jaws(size), 0.01, {.position = {0.025, 0.024, height + 0.003}}, 0.01);
  REQUIRE(above);
  CHECK(above->gap == near(0.003, 1e-9));
  CHECK((above->normal - Vec3d::UnitZ()).norm() < 1e-9);
  // Around the block, whose faces are at 0 and 0.05: 2 mm before the one and 5 mm behind the other.
  const auto around = approach_of(world, RigidShape::jaws(size), 0.057,
                                  {.position = {0.025, 0.025 + 0.0015, height - 0.02}}, 0.01);
  REQUIRE(around);
  CHECK(around->gap == near(0.002, 1e-9));
  CHECK((around->normal + Vec3d::UnitY()).norm() < 1e-9);
  CHECK_FALSE(
      approach_of(world, RigidShape::jaws(size), 0.08, {.position = {0.025, 0.025, height - 0.02}}, 0.01));
}

TEST_CASE("of a tool that is a mesh nothing is known before it touches") {
  World<double> world(flat_block());
  RigidShape shape{.kind = RigidShape::Kind::mesh};
  CHECK_FALSE(approach_of(world, shape, 0, {.position = {0.025, 0.025, height}}, 1));
}
