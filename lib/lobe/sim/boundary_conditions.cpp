#include "lobe/sim/boundary_conditions.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace lobe {

Mat3X<double> dead_loads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
                         const std::vector<VertexLoad>& vertex_loads) {
  Mat3X<double> loads = Mat3X<double>::Zero(3, elements.topology.vertex_count());
  for (const FaceLoad& load : face_loads) {
    if (!elements.topology.alive(load.tet)) continue;
    const Eigen::Vector3i v = elements.topology.face(4 * load.tet + load.face);
    const Vec3d a = elements.points.col(v[0]), b = elements.points.col(v[1]), c = elements.points.col(v[2]);
    const double area = (b - a).cross(c - a).norm() / 2;
    for (int i = 0; i < 3; ++i) loads.col(v[i]) += load.traction * area / 3;
  }
  for (const VertexLoad& load : vertex_loads)
    if (!elements.topology.around(load.vertex).empty()) loads.col(load.vertex) += load.force;
  return loads;
}

Vec3d path_at(const std::vector<PathPoint>& path, double time) {
  if (time <= path.front().time) return path.front().position;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (time >= path[i].time) continue;
    const double s = (time - path[i - 1].time) / (path[i].time - path[i - 1].time);
    return path[i - 1].position + s * (path[i].position - path[i - 1].position);
  }
  return path.back().position;
}

namespace {

std::uint8_t bits(const Axes& axes) {
  return static_cast<std::uint8_t>(axes[0] | axes[1] << 1 | axes[2] << 2);
}

}  // namespace

void HeldVertices::hold(const Held& item) {
  if (holds(item.vertex)) return add_axes(item);
  if (item.vertex >= static_cast<Index>(held_.size())) held_.resize(std::size_t(item.vertex) + 1, 0);
  held_[item.vertex] = bits(item.axes);
  items_.push_back(item);
}

void HeldVertices::add_axes(const Held& item) {
  if (fixes(item.vertex) || item.holder != boundary) return;
  Held& held = *std::find_if(items_.begin(), items_.end(),
                             [&](const Held& i) { return i.vertex == item.vertex && i.holder == boundary; });
  for (int i = 0; i < 3; ++i) {
    if (held.axes[i] || !item.axes[i]) continue;
    held.axes[i] = true;
    held.start[i] = item.start[i];
    held.goal[i] = item.goal[i];
  }
  held_[item.vertex] = bits(held.axes);
}

void HeldVertices::release(int holder) {
  for (const Held& item : items_)
    if (item.holder == holder) held_[item.vertex] = 0;
  std::erase_if(items_, [&](const Held& item) { return item.holder == holder; });
}

void HeldVertices::split(Index vertex, Index copy) {
  if (!holds(vertex)) return;
  Held item = *std::find_if(items_.begin(), items_.end(), [&](const Held& i) { return i.vertex == vertex; });
  item.vertex = copy;
  hold(item);
}

}  // namespace lobe
