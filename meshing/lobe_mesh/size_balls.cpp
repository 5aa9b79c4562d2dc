// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/size_balls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/text.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t balls_of_leaf = 8;

}  // namespace

SizeBalls::SizeBalls(std::vector<SizeBall> balls, double growth) : balls_(std::move(balls)), growth_(growth) {
  if (!balls_.empty()) build(0, balls_.size());
}

void SizeBalls::build(std::size_t begin, std::size_t end) {
  const std::size_t number = nodes_.size();
  Node node{{}, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), begin, end,
            0};
  for (std::size_t i = begin; i < end; ++i) {
    node.centres.extend(balls_[i].centre);
    node.shortest = std::min(node.shortest, balls_[i].edge);
    node.least = std::min(node.least, balls_[i].edge - growth_ * balls_[i].radius);
  }
  nodes_.push_back(node);
  if (end - begin <= balls_of_leaf) return;
  int axis = 0;
  node.centres.sizes().maxCoeff(&axis);
  const std::size_t middle = (begin + end) / 2;
  const auto place = [&](std::size_t i) { return balls_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(place(begin), place(middle), place(end),
                   [&](const SizeBall& a, const SizeBall& b) { return a.centre[axis] < b.centre[axis]; });
  build(begin, middle);
  nodes_[number].right = nodes_.size();
  build(middle, end);
}

void SizeBalls::lower(const Vec3d& point, std::size_t number, double& edge) const {
  const Node& node = nodes_[number];
  const double bound = node.least + growth_ * node.centres.exteriorDistance(point);
  if (std::max(node.shortest, bound) >= edge) return;
  if (node.right != 0) {
    const std::size_t left = number + 1, right = node.right;
    const bool left_first = nodes_[left].centres.squaredExteriorDistance(point) <=
                            nodes_[right].centres.squaredExteriorDistance(point);
    lower(point, left_first ? left : right, edge);
    lower(point, left_first ? right : left, edge);
    return;
  }
  for (std::size_t i = node.begin; i < node.end; ++i) {
    const SizeBall& ball = balls_[i];
    edge = std::min(edge, ball.edge + growth_ * std::max(0.0, (point - ball.centre).norm() - ball.radius));
  }
}

double SizeBalls::at(const Vec3d& point, double edge) const {
  if (!nodes_.empty()) lower(point, 0, edge);
  return edge;
}

std::vector<SizeBall> read_size_balls(const std::filesystem::path& file) {
  const MeshFile read = read_mesh(file);
  const auto array = read.point_data.find("edge");
  if (array == read.point_data.end() || array->second.rows() != 1)
    throw InputError(file.string(),
                     "has no point array 'edge' with the length of the edges [m] at each vertex (.vtu)");
  std::vector<double> volume(read.mesh.vertex_count(), 0);
  for (Index t = 0; t < read.mesh.tet_count(); ++t) {
    for (const Index v : read.mesh.tets.col(t)) volume[v] += signed_volume(tet_points(read.mesh, t)) / 4;
  }
  std::vector<SizeBall> balls;
  for (Index v = 0; v < read.mesh.vertex_count(); ++v) {
    const double edge = array->second(0, v);
    if (!(std::isfinite(edge) && edge > 0))
      throw InputError(file.string(),
                       "edge " + rounded(edge) + " at vertex " + std::to_string(v) + ", must be positive");
    balls.push_back({read.mesh.points.col(v), std::cbrt(volume[v] * 3 / (4 * std::numbers::pi)), edge});
  }
  return balls;
}

}  // namespace lobe::meshing
