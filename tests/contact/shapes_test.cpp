#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "lobe/contact/rigid_motion.h"
#include "lobe/contact/signed_distance.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("distances to spheres, capsules and boxes") {
  CHECK(distance_to_sphere(0.01, {0, 0.03, 0}).value == near(0.02, 1e-12));
  CHECK(distance_to_sphere(0.01, Vec3d::Zero()).value == near(-0.01, 1e-12));
  CHECK(distance_to_sphere(0.01, Vec3d::Zero()).gradient.norm() == near(1, 1e-12));
  CHECK(distance_to_capsule(0.01, 0.1, {0.03, 0, 0.05}).value == near(0.02, 1e-12));
  CHECK(distance_to_capsule(0.01, 0.1, {0, 0, 0.13}).value == near(0.02, 1e-12));
  CHECK(distance_to_capsule(0.01, 0.1, {0, 0, -0.03}).value == near(0.02, 1e-12));
  CHECK(distance_to_box({1, 2, 3}, {4, 6, 0}).value == near(5, 1e-12));
  CHECK(distance_to_box({1, 2, 3}, {-0.75, 0, 0}).value == near(-0.25, 1e-12));
  CHECK(distance_to_box({1, 2, 3}, {-0.75, 0, 0}).gradient == Vec3d(-1, 0, 0));
}

TEST_CASE("the gradient of a distance is its slope, and of length 1") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.03, 0.03);
  for (const RigidShape& shape :
       {RigidShape::sphere(0.012), RigidShape::capsule(0.008, 0.02), RigidShape::box({0.02, 0.03, 0.025})}) {
    const SignedDistance distance(shape);
    for (int i = 0; i < 200; ++i) {
      const Vec3d x(uniform(random), uniform(random), uniform(random));
      const Distance at = distance.at(x);
      CHECK(at.gradient.norm() == near(1, 1e-12));
      // Along its gradient it is linear on both sides, but where a box has its medial planes.
      const double h = 1e-6;
      const double slope =
          (distance.at(x + h * at.gradient).value - distance.at(x - h * at.gradient).value) / (2 * h);
      CHECK(slope == near(1, 1e-6));
    }
  }
}

TEST_CASE("what is said to be beyond a gap is no nearer, and little that is beyond is not said to be") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-0.03, 0.03);
  for (const RigidShape& shape :
       {RigidShape::sphere(0.01), RigidShape::capsule(0.006, 0.02), RigidShape::box({0.01, 0.02, 0.03}),
        RigidShape::plane(), RigidShape::jaws({0.01, 0.006, 0.02})}) {
    const SignedDistance distance(shape);
    int beyond = 0, said = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3d x(any(random), any(random), any(random));
      for (double gap : {0.0, 0.004}) {
        const bool is_beyond = distance.at(x, 0.008).value >= gap;
        beyond += is_beyond;
        said += distance.is_beyond(x, gap, 0.008);
        CHECK((is_beyond || !distance.is_beyond(x, gap, 0.008)));
      }
    }
    CHECK(said > 0.9 * beyond);
  }
}

TEST_CASE("a tool moves uniformly between the rows of its path, and turns about its position") {
  const auto quaternion = [](double angle) {
    return Eigen::Vector4d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3d::UnitZ())).coeffs());
  };
  const std::vector<PathPoint> path{{1, {0, 0, 0}, quaternion(0)}, {3, {0.2, 0, 0}, quaternion(0.5)}};
  const RigidMotion motion = motion_at(path, 2);
  CHECK(motion.position.x() == near(0.1, 1e-12));
  CHECK((motion.velocity - Vec3d(0.1, 0, 0)).norm() < 1e-9);
  CHECK((motion.spin - Vec3d(0, 0, 0.25)).norm() < 1e-8);
  CHECK((motion.rotation * Vec3d::UnitX() - Vec3d(std::cos(0.25), std::sin(0.25), 0)).norm() < 1e-12);
  CHECK((motion.velocity_at({0.1, 0.4, 0}) - Vec3d(0, 0, 0)).norm() < 1e-8);
  CHECK(motion_at(path, 5).velocity.norm() == 0);
  CHECK(farthest_move(path, 0, 4, 0.1) == near(0.2 + 0.5 * 0.1, 1e-9));
  CHECK(farthest_move(path, 2, 2, 0.1) == 0);
}
