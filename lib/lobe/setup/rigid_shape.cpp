#include "lobe/setup/rigid_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace lobe {
namespace {

bool is_length(double x) { return std::isfinite(x) && x > 0; }

// Every edge is used once in each direction.
bool is_closed(const std::vector<Eigen::Vector3i>& triangles) {
  std::map<std::pair<int, int>, int> uses;
  for (const Eigen::Vector3i& t : triangles)
    for (int i = 0; i < 3; ++i) ++uses[{t[i], t[(i + 1) % 3]}];
  return std::all_of(uses.begin(), uses.end(), [&](const auto& edge) {
    const auto back = uses.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != uses.end() && back->second == 1;
  });
}

std::pair<Vec3d, Vec3d> box_of(const std::vector<Vec3d>& points) {
  Vec3d low = Vec3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {low, high};
}

double six_volumes(const RigidShape& shape) {
  double sum = 0;
  for (const Eigen::Vector3i& t : shape.triangles)
    sum += shape.points[std::size_t(t[0])].dot(
        shape.points[std::size_t(t[1])].cross(shape.points[std::size_t(t[2])]));
  return sum;
}

}  // namespace

void RigidShape::check(const Expect& expect, const std::string& whose) const {
  switch (kind) {
    case Kind::sphere:
      return expect(is_length(radius), whose + " needs a radius above 0 m, and finite");
    case Kind::capsule:
      return expect(is_length(radius) && std::isfinite(length) && length >= 0,
                    whose + " needs a radius above 0 m and a length of at least 0 m, both finite");
    case Kind::plane:
      return;
    case Kind::box:
    case Kind::jaws:
      return expect(is_length(size[0]) && is_length(size[1]) && is_length(size[2]),
                    whose + " needs edges above 0 m, and finite");
    case Kind::mesh:
      break;
  }
  const auto count = static_cast<int>(points.size());
  const auto is_there = [&](const Eigen::Vector3i& t) { return t.minCoeff() >= 0 && t.maxCoeff() < count; };
  const bool is_complete =
      !triangles.empty() && std::all_of(triangles.begin(), triangles.end(), is_there) &&
      std::all_of(points.begin(), points.end(), [](const Vec3d& p) { return p.allFinite(); });
  expect(is_complete, whose + " needs triangles between finite vertices that there are");
  if (!is_complete) return;
  const bool closed = is_closed(triangles);
  expect(closed, whose + " needs a closed surface: an edge has not two triangles of the same orientation");
  if (closed) expect(six_volumes(*this) > 0, whose + " needs triangles that look outwards");
}

double RigidShape::fineness() const {
  switch (kind) {
    case Kind::sphere:
    case Kind::capsule:
      return radius;
    case Kind::box:
    case Kind::jaws:
      return size.minCoeff() / 2;
    case Kind::plane:
      return std::numeric_limits<double>::infinity();
    case Kind::mesh:
      break;
  }
  const auto [low, high] = box_of(points);
  return (high - low).minCoeff() / 2;
}

double RigidShape::reach() const {
  switch (kind) {
    case Kind::sphere:
      return radius;
    case Kind::capsule:
      return radius + length;
    case Kind::box:
      return size.norm() / 2;
    case Kind::jaws:
      return Vec3d(size[0] / 2, size[1], size[2]).norm();
    case Kind::plane:
      return std::numeric_limits<double>::infinity();
    case Kind::mesh:
      break;
  }
  double farthest = 0;
  for (const Vec3d& p : points) farthest = std::max(farthest, p.norm());
  return farthest;
}

}  // namespace lobe
