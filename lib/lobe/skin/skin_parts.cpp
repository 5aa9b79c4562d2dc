// Triangles of a skin that blades have divided: their parts, and the vertices that these have on the edges.
#include <algorithm>

#include "lobe/diagnostics/locate.h"
#include "lobe/skin/divide_triangle.h"
#include "lobe/skin/skin.h"

namespace lobe {

// ---- Slots

// Begins a new revision, once per edit.
void Skin::begin_revision() {
  if (std::exchange(has_new_revision_, true)) return;
  ++mesh_.revision;
  mesh_.changed_triangles.next(mesh_.triangles.size());
  mesh_.changed_vertices.next(mesh_.file_vertex.size());
}

void Skin::show(Index number, Index file_triangle, const Eigen::Vector3i& drawn,
                const Eigen::Vector3i& carried) {
  begin_revision();
  slot_of_[number] = mesh_.triangle_count();
  mesh_.changed_triangles.record(slot_of_[number]);
  mesh_.triangles.push_back(drawn);
  mesh_.file_triangle.push_back(file_triangle);
  shown_.push_back(carried);
  number_of_.push_back(number);
}

// Takes a triangle out; the last one takes its slot.
void Skin::take_out(Index number) {
  begin_revision();
  const Index slot = std::exchange(slot_of_[number], -1), last = mesh_.triangle_count() - 1;
  if (slot != last) {
    mesh_.triangles[slot] = mesh_.triangles[last];
    mesh_.file_triangle[slot] = mesh_.file_triangle[last];
    shown_[slot] = shown_[last];
    number_of_[slot] = number_of_[last];
    slot_of_[number_of_[slot]] = slot;
    mesh_.changed_triangles.record(slot);
  }
  twice_area_[number].setZero();
  mesh_.triangles.pop_back();
  mesh_.file_triangle.pop_back();
  shown_.pop_back();
  number_of_.pop_back();
}

// Takes a triangle of the file out, or all its parts. Returns its corners as they were drawn.
Eigen::Vector3i Skin::take_apart(Index triangle) {
  const auto at = divided_.find(triangle);
  if (at == divided_.end()) {
    const Eigen::Vector3i corners = mesh_.triangles[slot_of_[triangle]];
    take_out(triangle);
    return corners;
  }
  const auto carried = static_cast<Index>(points_.cols());
  for (Index part : at->second.parts) {
    for (Index vertex : shown_[slot_of_[part]]) {
      if (vertex < carried) continue;
      CutVertex& own = cut_[vertex - carried];
      if (--own.uses > 0) continue;
      cut_at_.erase(own.place);
      unused_cut_.push_back(vertex - carried);
    }
    take_out(part);
    unused_parts_.push_back(part);
  }
  const Eigen::Vector3i corners = at->second.corners;
  divided_.erase(at);
  return corners;
}

// ---- Division

// The rim of a triangle, from its corner 0 on.
Skin::Rim Skin::rim_of(const Body& body, Index triangle, const Eigen::Vector3i& drawn) const {
  const Eigen::Vector3i own = corners_of_.col(triangle);
  Rim rim;
  for (int side = 0; side < 3; ++side) {
    const int next = (side + 1) % 3;
    const Index corner = under(body, own[side]);
    rim.points.push_back({side, 0, corner, corner});
    rim.places.push_back({own[side], own[side], drawn[side], drawn[side], 0});
    const auto at = gaps_.find(std::minmax(own[side], own[next]));
    if (at == gaps_.end()) continue;
    const bool is_forward = own[side] < own[next];
    const int a = is_forward ? side : next, b = is_forward ? next : side;
    const auto first = std::ptrdiff_t(rim.points.size());
    for (const Gap& gap : at->second) {
      if (is_forward)
        rim.points.push_back({side, gap.share, gap.before, gap.after});
      else
        rim.points.push_back({side, 1 - gap.share, gap.after, gap.before});
      rim.places.push_back({own[a], own[b], drawn[a], drawn[b], gap.share});
    }
    if (is_forward) continue;
    std::reverse(rim.points.begin() + first, rim.points.end());
    std::reverse(rim.places.begin() + first, rim.places.end());
  }
  return rim;
}

Vec3d Skin::at_rest(const OnEdge& place) const {
  return (1 - place.share) * points_.col(place.a) + place.share * points_.col(place.b);
}

// The tetrahedron under the middle of the three or more points between which a triangle is divided.
Index Skin::under_middle(const Body& body, Index triangle, const Rim& rim) const {
  Vec3d sum = Vec3d::Zero();
  int count = 0;
  for (const OnEdge& place : rim.places) {
    if (place.share == 0) continue;
    sum += at_rest(place);
    ++count;
  }
  return count < 3 ? -1 : under(body, lies_on_[triangle], sum / count, -1);
}

void Skin::divide(const Body& body, Index triangle) {
  const auto at = divided_.find(triangle);
  const Eigen::Vector3i drawn =
      at != divided_.end() ? at->second.corners : mesh_.triangles[slot_of_[triangle]];
  const Rim rim = rim_of(body, triangle, drawn);
  if (rim.points.size() == 3) {
    const bool is_gone =
        std::all_of(rim.points.begin(), rim.points.end(), [](const RimPoint& p) { return p.after < 0; });
    if (at == divided_.end() && !is_gone) return;
    take_apart(triangle);
    if (!is_gone) show(triangle, triangle, drawn, corners_of_.col(triangle));
    return;
  }
  const auto on_one_side = [&](Index element, Index other) {
    return element == other ||
           (element >= 0 && other >= 0 && touch(body.topology, element, other) == Touch::together);
  };
  take_apart(triangle);
  Divided& divided = divided_.emplace(triangle, Divided{drawn, {}}).first->second;
  for (const TrianglePart& part : divide_triangle(rim.points, under_middle(body, triangle, rim), on_one_side))
    if (std::none_of(part.elements.begin(), part.elements.end(), [](Index e) { return e < 0; }))
      divided.parts.push_back(show_part(body.topology, triangle, rim, part));
}

Index Skin::show_part(const Topology& topology, Index triangle, const Rim& rim, const TrianglePart& part) {
  Eigen::Vector3i drawn, carried;
  for (std::size_t k = 0; k < 3; ++k) {
    const OnEdge& place = rim.places[std::size_t(part.points[k])];
    const Index vertex = place.share > 0 ? cut_vertex(topology, place, part.elements[k]) : -1;
    drawn[Eigen::Index(k)] = vertex < 0 ? place.drawn_a : first_cut() + vertex;
    carried[Eigen::Index(k)] = vertex < 0 ? place.a : static_cast<Index>(points_.cols()) + vertex;
  }
  if (unused_parts_.empty()) {
    unused_parts_.push_back(static_cast<Index>(slot_of_.size()));
    slot_of_.push_back(-1);
    twice_area_.push_back(Eigen::Vector4f::Zero());
  }
  const Index number = unused_parts_.back();
  unused_parts_.pop_back();
  show(number, triangle, drawn, carried);
  return number;
}

// Returns the vertex at a place, or makes one.
Index Skin::cut_vertex(const Topology& topology, const OnEdge& place, Index element) {
  const auto [at, is_new] = cut_at_.try_emplace({place.drawn_a, place.drawn_b, place.share, element}, -1);
  if (is_new) {
    if (unused_cut_.empty()) add_cut_vertex();
    at->second = unused_cut_.back();
    unused_cut_.pop_back();
    CutVertex& own = cut_[at->second];
    own = {at->first, element, topology.corners(element),
           barycentric(start_, topology.parent(element), at_rest(place)).cast<float>(), 0};
    const auto share = static_cast<float>(place.share);
    const Index vertex = first_cut() + at->second;
    mesh_.between[at->second] = {place.drawn_a, place.drawn_b, share};
    mesh_.file_vertex[vertex] = mesh_.file_vertex[place.share < 0.5 ? place.drawn_a : place.drawn_b];
    mesh_.texture[vertex] = (1 - share) * mesh_.texture[place.drawn_a] + share * mesh_.texture[place.drawn_b];
    mesh_.changed_vertices.record(vertex);
  }
  cut_[at->second].corners = topology.corners(element);
  ++cut_[at->second].uses;
  return at->second;
}

void Skin::add_cut_vertex() {
  unused_cut_.push_back(static_cast<Index>(cut_.size()));
  cut_.emplace_back();
  mesh_.between.emplace_back();
  mesh_.file_vertex.push_back(0);
  mesh_.texture.push_back(Eigen::Vector2f::Zero());
}

// Updates the vertices of a triangle's parts whose tetrahedra have other corners now.
void Skin::update_cut_vertices(const Topology& topology, Index triangle) {
  const auto at = divided_.find(triangle);
  if (at == divided_.end()) return;
  const auto carried = static_cast<Index>(points_.cols());
  for (Index part : at->second.parts)
    for (Index vertex : shown_[slot_of_[part]])
      if (vertex >= carried && topology.alive(cut_[vertex - carried].element))
        cut_[vertex - carried].corners = topology.corners(cut_[vertex - carried].element);
}

// ---- Frames

void Skin::list_parts_around() {
  const auto carried = static_cast<Index>(points_.cols());
  parts_around_.clear();
  for (const auto& [triangle, divided] : divided_)
    for (Index part : divided.parts)
      for (Index vertex : shown_[slot_of_[part]])
        if (vertex < carried) parts_around_.push_back({vertex, part});
  std::sort(parts_around_.begin(), parts_around_.end());
  listed_at_ = mesh_.revision;
}

void Skin::find_cut_positions(Mat3X<float>& x) {
  const auto carried = std::size_t(points_.cols());
  for (std::size_t i = 0; i < cut_.size(); ++i) {
    const Eigen::Vector4f& w = cut_[i].weights;
    const Eigen::Vector4i& c = cut_[i].corners;
    x_[carried + i] =
        (w[0] * mesh_x_[c[0]] + w[1] * mesh_x_[c[1]]) + (w[2] * mesh_x_[c[2]] + w[3] * mesh_x_[c[3]]);
    x.col(first_cut() + Index(i)) = x_[carried + i].head<3>();
  }
}

void Skin::find_cut_normals(Mat3X<float>& normals) const {
  if (cut_.empty()) return;
  const auto carried = static_cast<Index>(points_.cols());
  auto own = normals.rightCols(Eigen::Index(cut_.size()));
  own.setZero();
  for (const auto& [triangle, divided] : divided_)
    for (Index part : divided.parts)
      for (Index vertex : shown_[slot_of_[part]])
        if (vertex >= carried) own.col(vertex - carried) += twice_area_[part].head<3>();
  for (auto normal : own.colwise())
    if (const float length = normal.norm(); length > 0) normal /= length;
}

}  // namespace lobe
