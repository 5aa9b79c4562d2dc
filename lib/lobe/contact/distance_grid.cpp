#include "lobe/contact/distance_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "lobe/cut/distance.h"

namespace lobe {
namespace {

double angle_at(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  return std::atan2((a - p).cross(b - p).norm(), (a - p).dot(b - p));
}

double square_to_box(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
  return (x - x.cwiseMax(low).cwiseMin(high)).squaredNorm();
}

}  // namespace

NearestTriangle::NearestTriangle(const std::vector<Vec3d>& points,
                                 const std::vector<Eigen::Vector3i>& triangles)
    : points_(points), triangles_(triangles), point_normals_(points.size(), Vec3d::Zero()) {
  std::map<std::pair<int, int>, Vec3d> of_edge;
  for (const Eigen::Vector3i& t : triangles) {
    const std::array<Vec3d, 3> x{points[std::size_t(t[0])], points[std::size_t(t[1])],
                                 points[std::size_t(t[2])]};
    centres_.push_back((x[0] + x[1] + x[2]) / 3);
    const Vec3d n = (x[1] - x[0]).cross(x[2] - x[0]);
    face_normals_.push_back(n.norm() > 0 ? Vec3d(n.normalized()) : Vec3d::Zero());
    for (int c = 0; c < 3; ++c) {
      const int next = (c + 1) % 3;
      point_normals_[std::size_t(t[c])] +=
          angle_at(x[std::size_t(c)], x[std::size_t(next)], x[std::size_t((c + 2) % 3)]) *
          face_normals_.back();
      of_edge.try_emplace(std::minmax(t[c], t[next]), Vec3d::Zero()).first->second += face_normals_.back();
    }
  }
  for (const Eigen::Vector3i& t : triangles) {
    auto& normals = edge_normals_.emplace_back();
    for (int c = 0; c < 3; ++c) normals[std::size_t(c)] = of_edge.at(std::minmax(t[c], t[(c + 1) % 3]));
  }
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(order_.size()));
}

// Halves along the longest edge of the box of their centres.
int NearestTriangle::build(int first, int count) {
  const auto number = static_cast<int>(nodes_.size());
  Node node;
  node.low = Vec3d::Constant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  for (int i = first; i < first + count; ++i)
    for (int p : triangles_[std::size_t(order_[std::size_t(i)])]) {
      node.low = node.low.cwiseMin(points_[std::size_t(p)]);
      node.high = node.high.cwiseMax(points_[std::size_t(p)]);
    }
  nodes_.push_back(node);
  if (count <= 4) {
    nodes_[std::size_t(number)].first = first;
    nodes_[std::size_t(number)].count = count;
    return number;
  }
  int axis;
  (node.high - node.low).maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) {
    return centres_[std::size_t(a)][axis] < centres_[std::size_t(b)][axis];
  });
  const int left = build(first, count / 2), right = build(first + count / 2, count - count / 2);
  nodes_[std::size_t(number)].left = left;
  nodes_[std::size_t(number)].right = right;
  return number;
}

void NearestTriangle::search(int number, const Vec3d& x, Nearest& best) const {
  const Node& node = nodes_[std::size_t(number)];
  for (int i = node.first; i < node.first + node.count; ++i) {
    const int t = order_[std::size_t(i)];
    const Eigen::Vector3i& corners = triangles_[std::size_t(t)];
    const Vec3d p = nearest_on_triangle(x, points_[std::size_t(corners[0])], points_[std::size_t(corners[1])],
                                        points_[std::size_t(corners[2])]);
    if (const double square = (x - p).squaredNorm(); square < best.square) best = {square, t, p};
  }
  if (node.count > 0) return;
  const auto far = [&](int child) {
    return square_to_box(x, nodes_[std::size_t(child)].low, nodes_[std::size_t(child)].high);
  };
  const double left = far(node.left), right = far(node.right);
  const int nearer = left <= right ? node.left : node.right, other = left <= right ? node.right : node.left;
  if (std::min(left, right) < best.square) search(nearer, x, best);
  if (std::max(left, right) < best.square) search(other, x, best);
}

// Of the corner, the edge or the face on which the nearest point lies.
Vec3d NearestTriangle::normal_at(const Nearest& nearest) const {
  const Eigen::Vector3i& t = triangles_[std::size_t(nearest.triangle)];
  const Vec3d a = points_[std::size_t(t[0])], b = points_[std::size_t(t[1])], c = points_[std::size_t(t[2])];
  const Vec3d n = (b - a).cross(c - a);
  const double twice = n.squaredNorm(), small = 1e-9;
  const Vec3d p = nearest.point;
  const Vec3d weights((b - p).cross(c - p).dot(n) / twice, (c - p).cross(a - p).dot(n) / twice,
                      (a - p).cross(b - p).dot(n) / twice);
  for (int i = 0; i < 3; ++i)
    if (weights[i] > 1 - small) return point_normals_[std::size_t(t[i])];
  for (int i = 0; i < 3; ++i)
    if (weights[(i + 2) % 3] < small) return edge_normals_[std::size_t(nearest.triangle)][std::size_t(i)];
  return face_normals_[std::size_t(nearest.triangle)];
}

double NearestTriangle::signed_distance(const Vec3d& x) const {
  Nearest best{std::numeric_limits<double>::infinity()};
  search(0, x, best);
  return std::copysign(std::sqrt(best.square), (x - best.point).dot(normal_at(best)));
}

DistanceGrid::DistanceGrid(const std::vector<Vec3d>& points, const std::vector<Eigen::Vector3i>& triangles) {
  low_ = high_ = points.front();
  for (const Vec3d& p : points) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
  cell_ = (high_ - low_).maxCoeff() / cells;
  low_.array() -= 2 * cell_;
  for (int i = 0; i < 3; ++i) {
    count_[i] = static_cast<int>(std::ceil((high_[i] + 2 * cell_ - low_[i]) / cell_)) + 1;
    high_[i] = low_[i] + (count_[i] - 1) * cell_;
  }
  const NearestTriangle exact(points, triangles);
  values_.reserve(std::size_t(count_.prod()));
  for (int k = 0; k < count_[2]; ++k)
    for (int j = 0; j < count_[1]; ++j)
      for (int i = 0; i < count_[0]; ++i)
        values_.push_back(exact.signed_distance(low_ + cell_ * Vec3d(i, j, k)));
}

Distance DistanceGrid::at(const Vec3d& x) const {
  const Vec3d inside = x.cwiseMax(low_).cwiseMin(high_), at = (inside - low_) / cell_;
  Eigen::Vector3i from;
  for (int i = 0; i < 3; ++i) from[i] = std::clamp(static_cast<int>(at[i]), 0, count_[i] - 2);
  const Vec3d s = at - from.cast<double>(), r = Vec3d::Ones() - s;
  std::array<double, 8> f;
  for (int c = 0; c < 8; ++c)
    f[std::size_t(c)] = value(from[0] + (c & 1), from[1] + (c >> 1 & 1), from[2] + (c >> 2));
  const double x00 = r[0] * f[0] + s[0] * f[1], x10 = r[0] * f[2] + s[0] * f[3];
  const double x01 = r[0] * f[4] + s[0] * f[5], x11 = r[0] * f[6] + s[0] * f[7];
  const double y0 = r[1] * x00 + s[1] * x10, y1 = r[1] * x01 + s[1] * x11;
  Distance found;
  found.value = r[2] * y0 + s[2] * y1;
  found.gradient = Vec3d(r[2] * (r[1] * (f[1] - f[0]) + s[1] * (f[3] - f[2])) +
                             s[2] * (r[1] * (f[5] - f[4]) + s[1] * (f[7] - f[6])),
                         r[2] * (x10 - x00) + s[2] * (x11 - x01), y1 - y0) /
                   cell_;
  if (const double beyond = (x - inside).norm(); beyond > 0) {
    found.value = std::max(beyond, found.value - beyond);
    found.gradient = (x - inside) / beyond;
  }
  return found;
}

}  // namespace lobe
