#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <random>

#include "contact/frame.h"
#include "lobe/contact/distance_grid.h"
#include "lobe/error.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A cube from triangles of n² squares per face, blown up to a sphere if wanted.
RigidShape cube_of_triangles(int n, double half, bool round) {
  RigidShape shape{.kind = RigidShape::Kind::mesh};
  std::map<std::array<int, 3>, int> numbers;
  const auto point = [&](const Eigen::Vector3i& at) {
    const auto [found, is_new] = numbers.try_emplace({at[0], at[1], at[2]}, int(shape.points.size()));
    if (is_new) {
      Vec3d x = half * (2 * at.cast<double>() / n - Vec3d::Ones());
      if (round) x = half * x.normalized();
      shape.points.push_back(x);
    }
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            Eigen::Vector3i at;
            at[axis] = side * n;
            at[(axis + 1) % 3] = i + a;
            at[(axis + 2) % 3] = j + b;
            return point(at);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 1) {
            shape.triangles.emplace_back(a, b, c);
            shape.triangles.emplace_back(a, c, d);
          } else {
            shape.triangles.emplace_back(a, c, b);
            shape.triangles.emplace_back(a, d, c);
          }
        }
  return shape;
}

}  // namespace

TEST_CASE("the signed distance to a cube of triangles is that to the box") {
  const double half = 0.01;
  const RigidShape shape = cube_of_triangles(3, half, false);
  const NearestTriangle nearest(shape.points, shape.triangles);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.02, 0.02);
  for (int i = 0; i < 500; ++i) {
    const Vec3d x(uniform(random), uniform(random), uniform(random));
    CHECK(std::abs(nearest.signed_distance(x) - distance_to_box(Vec3d::Constant(half), x).value) < 1e-12);
  }
}

TEST_CASE("the grid of a mesh knows the distance to it, and no less far off") {
  const double radius = 0.01;
  const RigidShape shape = cube_of_triangles(16, radius, true);
  const SignedDistance distance(shape);
  CHECK(distance.reach() == near(radius, 1e-9));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.03, 0.03);
  for (int i = 0; i < 500; ++i) {
    const Vec3d x(uniform(random), uniform(random), uniform(random));
    const double exact = x.norm() - radius;
    const Distance found = distance.at(x);
    if (exact > 0.001) CHECK(found.value < exact + 1e-4);
    if (exact > 0) CHECK(found.value > 0.2 * exact - 1e-4);
    if (std::abs(exact) > 0.0005 || x.norm() < 0.003) continue;
    CHECK(std::abs(found.value - exact) < 1e-4);
    CHECK((found.gradient - x.normalized()).norm() < 0.08);
  }
}

TEST_CASE("the gradient between grid points is the slope of the value") {
  const SignedDistance distance(cube_of_triangles(6, 0.01, true));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (int i = 0; i < 100; ++i) {
    const Vec3d x(uniform(random), uniform(random), uniform(random));
    const double h = 1e-9;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d step = h * Vec3d::Unit(axis);
      const double slope = (distance.at(x + step).value - distance.at(x - step).value) / (2 * h);
      CHECK(std::abs(slope - distance.at(x).gradient[axis]) < 1e-4);
    }
  }
}

TEST_CASE("a mesh that is open, turned inside out or without points is refused") {
  const auto fault_of = [](const RigidShape& shape) {
    std::string text;
    shape.check([&](bool is_met, const std::string& fault) { text += is_met ? "" : fault; }, "it");
    return text;
  };
  RigidShape shape = cube_of_triangles(2, 0.01, false);
  CHECK(fault_of(shape) == "");
  RigidShape open = shape;
  open.triangles.pop_back();
  CHECK(fault_of(open) == "it needs a closed surface: an edge has not two triangles of the same orientation");
  RigidShape inside_out = shape;
  for (Eigen::Vector3i& t : inside_out.triangles) std::swap(t[0], t[1]);
  CHECK(fault_of(inside_out) == "it needs triangles that look outwards");
  shape.triangles[0][0] = 1000;
  CHECK(fault_of(shape) == "it needs triangles between finite vertices that there are");
  CHECK(fault_of({.kind = RigidShape::Kind::mesh}) ==
        "it needs triangles between finite vertices that there are");
}

TEST_CASE("a probe of triangles presses like the sphere that it stands for, and an obstacle like a probe") {
  const double radius = 0.012;
  struct Pressed {
    Mat3X<double> u;   // [m]
    double force = 0;  // on the probe [N]
  };
  const auto press = [&](const RigidShape& shape, bool is_obstacle) {
    Setup setup = setup_of(irregular_box(5), RegionModel::nonlinear);
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
    setup.damping = 15;
    const Vec3d place(0.025, 0.022, 0.059);
    if (is_obstacle)
      setup.contact.obstacles.push_back(
          {.name = "stone", .shape = shape, .position = place, .friction = 0.1});
    else
      setup.probes.push_back({"tip", shape, 0.1, {{0, place}}});
    World<double> world(setup);
    for (int i = 0; i < 15; ++i) world.advance(frame);
    return Pressed{world.state().u, is_obstacle ? 0 : world.tools().lists().probes.front().force.norm()};
  };
  const RigidShape triangles = cube_of_triangles(16, radius, true);
  const Pressed sphere = press(RigidShape::sphere(radius), false), mesh = press(triangles, false);
  CHECK(sphere.force > 0.1);
  CHECK(mesh.force == near(sphere.force, 0.03));
  CHECK((press(triangles, true).u - mesh.u).norm() < 1e-9 * mesh.u.norm());
}
