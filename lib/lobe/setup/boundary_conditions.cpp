#include "lobe/setup/boundary_conditions.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace lobe {

namespace {

// Numbers of the loads per tetrahedron or per vertex; place(load) returns which one.
template <class Load, class Place>
VertexLists<Index> by_place(const std::vector<Load>& loads, Index places, Place&& place) {
  if (loads.empty()) return {};
  std::vector<Index> lengths(std::size_t(places), 0);
  for (const Load& load : loads) ++lengths[place(load)];
  VertexLists<Index> lists(lengths);
  for (std::size_t i = 0; i < loads.size(); ++i) lists.append(place(loads[i]), static_cast<Index>(i));
  return lists;
}

double face_area(const Elements& elements, const Eigen::Vector3i& v) {
  const Vec3d a = elements.points.col(v[0]), b = elements.points.col(v[1]), c = elements.points.col(v[2]);
  return (b - a).cross(c - a).norm() / 2;
}

}  // namespace

DeadLoads::DeadLoads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
                     const std::vector<VertexLoad>& vertex_loads)
    : face_loads_(face_loads),
      vertex_loads_(vertex_loads),
      of_tet_(by_place(face_loads, elements.topology.tet_count(), [](const FaceLoad& l) { return l.tet; })),
      of_vertex_(by_place(vertex_loads, elements.topology.vertex_count(),
                          [](const VertexLoad& l) { return l.vertex; })) {}

Vec3d DeadLoads::at(const Elements& elements, Index vertex) const {
  Vec3d force = Vec3d::Zero();
  if (elements.topology.around(vertex).empty()) return force;
  if (of_tet_.vertex_count() > 0)
    for (Index t : elements.topology.around(vertex))
      for (Index i : of_tet_[elements.topology.parent(t)]) {
        const FaceLoad& load = face_loads_[i];
        const Eigen::Vector4i corners = elements.topology.corners(t);
        const int* c = face_corners[load.face];
        const Eigen::Vector3i face{corners[c[0]], corners[c[1]], corners[c[2]]};
        for (int k = 0; k < 3; ++k)
          if (face[k] == vertex) force += weights(t, load)[k] * load.traction * face_area(elements, face) / 3;
      }
  if (vertex < of_vertex_.vertex_count())
    for (Index i : of_vertex_[vertex]) force += vertex_loads_[i].force;
  return force;
}

std::vector<int> DeadLoads::loaded_faces(Index tet) const {
  std::vector<int> faces;
  if (tet >= of_tet_.vertex_count()) return faces;
  for (Index i : of_tet_[tet]) faces.push_back(face_loads_[i].face);
  return faces;
}

Vec3d DeadLoads::weights(Index tet, const FaceLoad& load) const {
  const auto at = weights_.find(4 * tet + load.face);
  return at == weights_.end() ? load.weights : at->second;
}

Mat3X<double> dead_loads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
                         const std::vector<VertexLoad>& vertex_loads) {
  const DeadLoads loads(elements, face_loads, vertex_loads);
  Mat3X<double> at_vertices(3, elements.topology.vertex_count());
  for (Index v = 0; v < at_vertices.cols(); ++v) at_vertices.col(v) = loads.at(elements, v);
  return at_vertices;
}

namespace {

struct Between {
  const PathPoint *from, *to;
  double share;
};

Between between(const std::vector<PathPoint>& path, double time) {
  const auto next = std::upper_bound(path.begin(), path.end(), time,
                                     [](double t, const PathPoint& point) { return t < point.time; });
  if (next == path.begin()) return {&path.front(), &path.front(), 0};
  if (next == path.end()) return {&path.back(), &path.back(), 0};
  const PathPoint &from = *(next - 1), &to = *next;
  return {&from, &to, (time - from.time) / (to.time - from.time)};
}

}  // namespace

Vec3d path_at(const std::vector<PathPoint>& path, double time) {
  const Between at = between(path, time);
  return at.from->position + at.share * (at.to->position - at.from->position);
}

Eigen::Vector4d orientation_at(const std::vector<PathPoint>& path, double time) {
  const Between at = between(path, time);
  if (at.from->orientation == at.to->orientation) return at.from->orientation;
  const Eigen::Quaterniond a(at.from->orientation), b(at.to->orientation);
  return a.slerp(at.share, b).coeffs();
}

double opening_at(const std::vector<PathPoint>& path, double time) {
  const Between at = between(path, time);
  return at.from->opening + at.share * (at.to->opening - at.from->opening);
}

namespace {

std::uint8_t bits(const Axes& axes) {
  return static_cast<std::uint8_t>(axes[0] | axes[1] << 1 | axes[2] << 2);
}

}  // namespace

void HeldVertices::hold(Held item) {
  if (item.vertex >= static_cast<Index>(held_.size())) held_.resize(std::size_t(item.vertex) + 1, 0);
  std::uint8_t& held = held_[item.vertex];
  if (item.share < 1) {
    held |= is_drawn;
    partly_.push_back(item);
    return;
  }
  for (int i = 0; i < 3; ++i) item.axes[i] = item.axes[i] && (held >> i & 1) == 0;
  if (item.axes == Axes{}) return;
  if ((held & all_components) == 0 || !joins(item)) items_.push_back(item);
  held |= bits(item.axes);
}

// Components that boundary conditions hold are together in one item.
bool HeldVertices::joins(const Held& item) {
  if (item.holder != boundary) return false;
  const auto same = std::find_if(items_.begin(), items_.end(), [&](const Held& i) {
    return i.vertex == item.vertex && i.holder == boundary;
  });
  if (same == items_.end()) return false;
  for (int i = 0; i < 3; ++i) {
    if (!item.axes[i]) continue;
    same->axes[i] = true;
    same->start[i] = item.start[i];
    same->goal[i] = item.goal[i];
  }
  return true;
}

void HeldVertices::release(int holder) {
  for (const Held& item : items_)
    if (item.holder == holder) held_[item.vertex] &= static_cast<std::uint8_t>(~bits(item.axes));
  std::erase_if(items_, [&](const Held& item) { return item.holder == holder; });
  if (std::erase_if(partly_, [&](const Held& item) { return item.holder == holder; }) > 0) find_drawn();
}

void HeldVertices::find_drawn() {
  for (std::uint8_t& held : held_) held &= all_components;
  for (const Held& item : partly_) held_[item.vertex] |= is_drawn;
}

void HeldVertices::free(Index vertex) {
  if (!anchors(vertex)) return;
  held_[vertex] = 0;
  for (std::vector<Held>* items : {&items_, &partly_})
    std::erase_if(*items, [&](const Held& item) { return item.vertex == vertex; });
}

int HeldVertices::holder_of(Index v) const {
  return std::find_if(items_.begin(), items_.end(), [&](const Held& i) { return i.vertex == v; })->holder;
}

void HeldVertices::split(Index vertex, Index copy) {
  if (!anchors(vertex)) return;
  for (Held item : as_saved()) {
    if (item.vertex != vertex) continue;
    item.vertex = copy;
    hold(item);
  }
}

std::vector<HeldVertices::Held> HeldVertices::as_saved() const {
  std::vector<Held> all = items_;
  all.insert(all.end(), partly_.begin(), partly_.end());
  return all;
}

HeldVertices held_by(const std::vector<PrescribedVertex>& prescribed) {
  HeldVertices held;
  for (const PrescribedVertex& p : prescribed)
    held.hold({p.vertex, HeldVertices::boundary, Vec3d::Zero(), p.displacement, p.axes});
  return held;
}

HeldVertices held_by(const Setup& setup) {
  HeldVertices held = held_by(setup.prescribed);
  for (const PartlyHeldVertex& p : setup.partly_held)
    held.hold({p.vertex, HeldVertices::boundary, Vec3d::Zero(), p.displacement, p.axes, p.share});
  return held;
}

}  // namespace lobe
