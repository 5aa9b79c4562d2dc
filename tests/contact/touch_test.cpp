// The loops over points side by side against one point after the other.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "lobe/contact/quadrature.h"
#include "lobe/contact/signed_distance.h"
#include "lobe/contact/touch_kernels.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

using Kind = RigidShape::Kind;

struct Corners {
  Mat3<double> x, v;  // in the tool's axes [m], [m/s]
};

// A triangle near the tool, n² points, some of which have anchors.
struct Case {
  TouchShape shape;
  ContactLaw law;
  int n;
  Corners corners;
  double held;
  std::vector<Vec3d> anchors;  // per point
  std::vector<char> has_anchor;
};

struct Found {
  std::vector<TouchBlock> blocks;
  std::vector<double> rows, forces;
  double grip = 0;
};

Case any_case(std::mt19937& random, Kind kind, int n) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&](double size) {
    return Vec3d(size * Vec3d(number(random), number(random), number(random)));
  };
  Case c{{kind, 0.01, 0.02, {0.02, 0.015, 0.03}, 0.004, number(random) * 0.01},
         {.damping = 1e-4, .deepest = 0.003, .friction = std::abs(number(random))},
         n,
         {},
         std::max(0.0, number(random)) * 0.001,
         {},
         {}};
  const Vec3d middle = vector(0.006) + Vec3d(0, 0, kind == Kind::plane ? 0 : 0.01);
  for (int i = 0; i < 3; ++i) {
    c.corners.x.col(i) = middle + vector(0.008);
    c.corners.v.col(i) = vector(0.1);
  }
  visit_centroids(n, [&](int, const Vec3d& weights) {
    c.anchors.push_back(c.corners.x * weights + vector(0.0004));
    c.has_anchor.push_back(number(random) > -0.5);
  });
  return c;
}

Found find(const Case& c, InstructionSet set) {
  const TouchKernels kernels = touch_kernels(set);
  constexpr int stride = PointBlock::width;
  Found found;
  found.rows.assign(6 * stride, 0);
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) {
      found.rows[std::size_t(d * stride + i)] = c.corners.x(d, i);
      found.rows[std::size_t((3 + d) * stride + i)] = c.corners.v(d, i);
    }
  TouchTriangle triangle{.stiffness = 3e5, .area = 2e-6, .points = {0, 1, 2}};
  for (int d = 0; d < 3; ++d) {
    const auto i = std::size_t(d);
    triangle.along[i] = (c.corners.x(d, 1) - c.corners.x(d, 0)) / c.n;
    triangle.up[i] = (c.corners.x(d, 2) - c.corners.x(d, 0)) / c.n;
    triangle.turn[i] = (triangle.along[i] + triangle.up[i]) / 3;
    triangle.start[i] = c.corners.x(d, 0) + triangle.turn[i];
  }
  const std::vector<PointBlock>& points = point_blocks(c.n);
  found.blocks.resize(points.size());
  for (std::size_t b = 0; b < points.size(); ++b) {
    found.blocks[b].points = &points[b];
    found.blocks[b].first = int(b) * PointBlock::width;
    for (std::size_t lane = 0; lane < std::size_t(PointBlock::width); ++lane) {
      const std::size_t q = b * std::size_t(PointBlock::width) + lane;
      if (q >= c.anchors.size()) continue;
      for (int d = 0; d < 3; ++d) found.blocks[b].anchor[std::size_t(d)][lane] = c.anchors[q][d];
      found.blocks[b].has_anchor[lane] = c.has_anchor[q];
    }
  }
  const int count = int(points.size());
  kernels.find_distances(c.shape, c.held, &triangle, found.blocks.data(), count);
  for (TouchBlock& block : found.blocks) block.held.fill(c.held);
  found.forces.assign(12, 0);
  found.grip = kernels.add_forces(c.law, c.shape, &triangle, found.blocks.data(), count,
                                  {found.rows.data() + 3 * stride, stride}, found.forces.data());
  return found;
}

Distance distance_to(const TouchShape& shape, const Vec3d& x) {
  switch (shape.kind) {
    case Kind::sphere:
      return distance_to_sphere(shape.radius, x);
    case Kind::capsule:
      return distance_to_capsule(shape.radius, shape.length, x);
    case Kind::box:
      return distance_to_box(shape.size / 2, x);
    case Kind::jaws:
      return distance_to_jaws(shape.size, shape.opening, x);
    default:
      return {x.z(), Vec3d::UnitZ()};
  }
}

// The formulae of tool_contact.h, as they stand there. Returns how many points are touched.
int check_against_formulae(const Case& c, const Found& found) {
  constexpr double stiffness = 3e5, area = 2e-6;
  Mat3<double> f = Mat3<double>::Zero();
  double grip = 0;
  int touched = 0;
  visit_centroids(c.n, [&](int q, const Vec3d& weights) {
    const TouchBlock& block = found.blocks[std::size_t(q / PointBlock::width)];
    const auto lane = std::size_t(q % PointBlock::width);
    const Vec3d x = c.corners.x * weights;
    CHECK((x - Vec3d(block.place[0][lane], block.place[1][lane], block.place[2][lane])).norm() < 1e-15);
    const Distance g = distance_to(c.shape, x);
    CHECK(std::abs(block.distance[lane] - g.value) < 1e-15);
    CHECK((block.touched >> lane & 1) == (g.value < c.held));
    if (g.value >= c.held) return;
    ++touched;
    const double side = x.y() < 0 ? -1 : 1;
    double approach = -g.gradient.dot(c.corners.v * weights);
    if (c.shape.kind == Kind::jaws) approach += g.gradient.y() * side * c.shape.opens / 2;
    const double elastic = stiffness * std::clamp(c.held - g.value, 0.0, c.law.deepest);
    const double p = std::max(0.0, elastic + c.law.damping * stiffness * approach);
    Vec3d force = area * p * g.gradient;
    Vec3d anchor = x;
    if (c.has_anchor[std::size_t(q)]) {
      Vec3d slip = x - c.anchors[std::size_t(q)];
      slip -= g.gradient * g.gradient.dot(slip);
      const double most = c.law.friction * p / (stiffness / 2);
      if (slip.norm() > most) slip *= most / slip.norm();
      force -= area * stiffness / 2 * slip;
      anchor -= slip;
    }
    CHECK((anchor - Vec3d(block.anchor[0][lane], block.anchor[1][lane], block.anchor[2][lane])).norm() <
          1e-15);
    f += force * weights.transpose();
    grip -= c.shape.kind == Kind::jaws ? side / 2 * force.y() : 0;
  });
  const double least = 1e-12 * (1e-3 + f.norm());
  for (int i = 0; i < 3; ++i)
    for (int d = 0; d < 3; ++d) CHECK(std::abs(found.forces[std::size_t(4 * i + d)] - f(d, i)) < least);
  CHECK(std::abs(found.grip - grip) < least);
  return touched;
}

}  // namespace

TEST_CASE("points of a triangle side by side have the weights of its centroids, strip by strip") {
  for (int n = 1; n <= most_divisions; ++n) {
    const std::vector<PointBlock>& blocks = point_blocks(n);
    int count = 0;
    visit_centroids(n, [&](int number, const Vec3d& weights) {
      const PointBlock& block = blocks[std::size_t(number / PointBlock::width)];
      const auto lane = std::size_t(number % PointBlock::width);
      for (std::size_t c = 0; c < 3; ++c) CHECK(block.weights[c][lane] == weights[int(c)]);
      CHECK((block.lanes >> lane & 1) == 1);
      const Strip of = strip(n, int(block.up[lane]));
      CHECK((of.begin <= number && number < of.end));
      ++count;
    });
    CHECK(count == n * n);
    CHECK(strip(n, n - 1).end == n * n);
    int lanes = 0;
    for (const PointBlock& block : blocks) lanes += std::popcount(block.lanes);
    CHECK(lanes == n * n);
  }
}

TEST_CASE("forces of points side by side are those of one point after the other") {
  std::mt19937 random(24);
  int touched = 0, cases = 0;
  for (Kind kind : {Kind::sphere, Kind::capsule, Kind::box, Kind::plane, Kind::jaws})
    for (int n : {1, 2, 3, 4, 7}) {
      for (int i = 0; i < 40; ++i, ++cases) {
        const Case c = any_case(random, kind, n);
        touched += check_against_formulae(c, find(c, InstructionSet::baseline));
      }
    }
  CHECK(touched > 5 * cases);
}

TEST_CASE("every instruction set gives a touch the same bits") {
  std::mt19937 random(25);
  const auto is_same = [](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), sizeof a) == 0;
  };
  for (InstructionSet set : available_instruction_sets())
    for (Kind kind : {Kind::sphere, Kind::capsule, Kind::box, Kind::plane, Kind::jaws, Kind::mesh})
      for (int n : {1, 3, 4, 9}) {
        const Case c = any_case(random, kind, n);
        const Found ours = find(c, set), theirs = find(c, InstructionSet::baseline);
        CHECK(std::memcmp(ours.forces.data(), theirs.forces.data(), 12 * sizeof(double)) == 0);
        CHECK(ours.grip == theirs.grip);
        for (std::size_t b = 0; b < ours.blocks.size(); ++b) {
          CHECK(ours.blocks[b].touched == theirs.blocks[b].touched);
          CHECK(is_same(ours.blocks[b].place, theirs.blocks[b].place));
          CHECK(is_same(ours.blocks[b].distance, theirs.blocks[b].distance));
          CHECK(is_same(ours.blocks[b].gradient, theirs.blocks[b].gradient));
          for (std::size_t lane = 0; lane < std::size_t(PointBlock::width); ++lane)
            for (std::size_t d = 0; d < 3; ++d)
              if (ours.blocks[b].touched >> lane & 1)
                CHECK(ours.blocks[b].anchor[d][lane] == theirs.blocks[b].anchor[d][lane]);
        }
      }
}

TEST_CASE("places and speeds are turned to a tool's axes alike by every instruction set") {
  std::mt19937 random(26);
  std::uniform_real_distribution<double> number(-1, 1);
  const Mat3<double> rotation = Eigen::AngleAxisd(0.7, Vec3d(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3d position(0.1, -0.2, 0.05), velocity(0.3, 0, -0.1), spin(1, -2, 0.5);
  TouchAxes axes{.position = {0.1, -0.2, 0.05}, .velocity = {0.3, 0, -0.1}, .spin = {1, -2, 0.5}};
  for (int d = 0; d < 3; ++d)
    for (int k = 0; k < 3; ++k) axes.to_tool[std::size_t(d)][std::size_t(k)] = rotation(k, d);
  constexpr int stride = 16, count = 11;
  std::vector<double> x(3 * stride), v(3 * stride);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = number(random);
    v[i] = number(random);
  }
  for (InstructionSet set : available_instruction_sets()) {
    std::vector<double> places = x, speeds = v;
    touch_kernels(set).to_axes(axes, {places.data(), stride}, {speeds.data(), stride}, count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = [&](const std::vector<double>& rows) {
        return Vec3d(rows[i], rows[stride + i], rows[2 * stride + i]);
      };
      const Vec3d place = rotation.transpose() * (at(x) - position);
      CHECK((at(places) - place).norm() < 1e-15);
      CHECK((at(speeds) - (rotation.transpose() * (at(v) - velocity) - spin.cross(place))).norm() < 2e-15);
    }
    std::vector<double> of_baseline = x, speeds_of_baseline = v;
    touch_kernels(InstructionSet::baseline)
        .to_axes(axes, {of_baseline.data(), stride}, {speeds_of_baseline.data(), stride}, count);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t d = 0; d < 3; ++d) {
        CHECK(places[d * stride + i] == of_baseline[d * stride + i]);
        CHECK(speeds[d * stride + i] == speeds_of_baseline[d * stride + i]);
      }
  }
}
