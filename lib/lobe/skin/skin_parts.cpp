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
  state_.slot_of[number] = mesh_.triangle_count();
  mesh_.changed_triangles.record(state_.slot_of[number]);
  mesh_.triangles.push_back(drawn);
  mesh_.file_triangle.push_back(file_triangle);
  state_.shown.push_back(carried);
  state_.number_of.push_back(number);
}

// Takes a triangle out; the last one takes its slot.
void Skin::take_out(Index number) {
  begin_revision();
  const Index slot = std::exchange(state_.slot_of[number], -1), last = mesh_.triangle_count() - 1;
  if (slot != last) {
    mesh_.triangles[slot] = mesh_.triangles[last];
    mesh_.file_triangle[slot] = mesh_.file_triangle[last];
    state_.shown[slot] = state_.shown[last];
    state_.number_of[slot] = state_.number_of[last];
    state_.slot_of[state_.number_of[slot]] = slot;
    mesh_.changed_triangles.record(slot);
  }
  mesh_.triangles.pop_back();
  mesh_.file_triangle.pop_back();
  state_.shown.pop_back();
  state_.number_of.pop_back();
}

// Takes a triangle of the file out, or all its parts. Returns its corners as they were drawn.
Eigen::Vector3i Skin::take_apart(Index triangle) {
  const auto at = state_.divided.find(triangle);
  if (at == state_.divided.end()) {
    const Eigen::Vector3i corners = mesh_.triangles[state_.slot_of[triangle]];
    take_out(triangle);
    return corners;
  }
  const auto carried = rest_.carried_count();
  for (Index part : at->second.parts) {
    for (Index vertex : state_.shown[state_.slot_of[part]]) {
      if (vertex < carried) continue;
      CutVertex& own = state_.cut[vertex - carried];
      if (--own.uses > 0) continue;
      state_.cut_at.erase(own.place);
      state_.unused_cut.push_back(vertex - carried);
    }
    take_out(part);
    state_.unused_parts.push_back(part);
  }
  const Eigen::Vector3i corners = at->second.corners;
  state_.divided.erase(at);
  return corners;
}

// ---- Division

// The rim of a triangle, from its corner 0 on.
Skin::Rim Skin::rim_of(const CutBody& body, Index triangle, const Eigen::Vector3i& drawn) const {
  const Eigen::Vector3i own = rest_.corners.col(triangle);
  Rim rim;
  for (int side = 0; side < 3; ++side) {
    const int next = (side + 1) % 3;
    const Index corner = under(body, own[side]);
    rim.points.push_back({side, 0, corner, corner});
    rim.places.push_back({own[side], own[side], drawn[side], drawn[side], 0});
    const auto at = state_.gaps.find(std::minmax(own[side], own[next]));
    if (at == state_.gaps.end()) continue;
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
  return (1 - place.share) * rest_.points.col(place.a) + place.share * rest_.points.col(place.b);
}

// The tetrahedron under the middle of the three or more points between which a triangle is divided.
Index Skin::under_middle(const CutBody& body, Index triangle, const Rim& rim) const {
  Vec3d sum = Vec3d::Zero();
  int count = 0;
  for (const OnEdge& place : rim.places) {
    if (place.share == 0) continue;
    sum += at_rest(place);
    ++count;
  }
  return count < 3 ? -1 : under(body, rest_.lies_on[triangle], sum / count, -1);
}

void Skin::divide(const CutBody& body, Index triangle) {
  const auto at = state_.divided.find(triangle);
  const Eigen::Vector3i drawn =
      at != state_.divided.end() ? at->second.corners : mesh_.triangles[state_.slot_of[triangle]];
  const Rim rim = rim_of(body, triangle, drawn);
  if (rim.points.size() == 3) {
    const bool is_gone =
        std::all_of(rim.points.begin(), rim.points.end(), [](const RimPoint& p) { return p.after < 0; });
    if (at == state_.divided.end() && !is_gone) return;
    take_apart(triangle);
    if (!is_gone) show(triangle, triangle, drawn, rest_.corners.col(triangle));
    return;
  }
  const auto on_one_side = [&](Index element, Index other) {
    return element == other ||
           (element >= 0 && other >= 0 && touch(body.topology, element, other) == Touch::together);
  };
  take_apart(triangle);
  Divided& divided = state_.divided.emplace(triangle, Divided{drawn, {}}).first->second;
  for (const TrianglePart& part : divide_triangle(rim.points, under_middle(body, triangle, rim), on_one_side))
    if (std::none_of(part.elements.begin(), part.elements.end(), [](Index e) { return e < 0; }))
      divided.parts.push_back(show_part(body.topology, triangle, rim, part));
}

Index Skin::show_part(const Topology& topology, Index triangle, const Rim& rim, const TrianglePart& part) {
  Eigen::Vector3i drawn, carried;
  for (std::size_t k = 0; k < 3; ++k) {
    const OnEdge& place = rim.places[std::size_t(part.points[k])];
    const Index vertex = place.share > 0 ? cut_vertex(topology, place, part.elements[k]) : -1;
    drawn[Eigen::Index(k)] = vertex < 0 ? place.drawn_a : rest_.first_cut() + vertex;
    carried[Eigen::Index(k)] = vertex < 0 ? place.a : rest_.carried_count() + vertex;
  }
  if (state_.unused_parts.empty()) {
    state_.unused_parts.push_back(static_cast<Index>(state_.slot_of.size()));
    state_.slot_of.push_back(-1);
  }
  const Index number = state_.unused_parts.back();
  state_.unused_parts.pop_back();
  show(number, triangle, drawn, carried);
  return number;
}

// Returns the vertex at a place, or makes one.
Index Skin::cut_vertex(const Topology& topology, const OnEdge& place, Index element) {
  const auto [at, is_new] =
      state_.cut_at.try_emplace({place.drawn_a, place.drawn_b, place.share, element}, -1);
  if (is_new) {
    if (state_.unused_cut.empty()) add_cut_vertex();
    at->second = state_.unused_cut.back();
    state_.unused_cut.pop_back();
    CutVertex& own = state_.cut[at->second];
    own = {at->first, element, topology.corners(element),
           barycentric(rest_.start, topology.parent(element), at_rest(place)).cast<float>(), 0};
    const auto share = static_cast<float>(place.share);
    const Index vertex = rest_.first_cut() + at->second;
    mesh_.between[at->second] = {place.drawn_a, place.drawn_b, share};
    mesh_.file_vertex[vertex] = mesh_.file_vertex[place.share < 0.5 ? place.drawn_a : place.drawn_b];
    mesh_.texture[vertex] = (1 - share) * mesh_.texture[place.drawn_a] + share * mesh_.texture[place.drawn_b];
    mesh_.changed_vertices.record(vertex);
  }
  state_.cut[at->second].corners = topology.corners(element);
  ++state_.cut[at->second].uses;
  return at->second;
}

void Skin::add_cut_vertex() {
  state_.unused_cut.push_back(static_cast<Index>(state_.cut.size()));
  state_.cut.emplace_back();
  mesh_.between.emplace_back();
  mesh_.file_vertex.push_back(0);
  mesh_.texture.push_back(Eigen::Vector2f::Zero());
}

// Updates the vertices of a triangle's parts whose tetrahedra have other corners now.
void Skin::update_cut_vertices(const Topology& topology, Index triangle) {
  const auto at = state_.divided.find(triangle);
  if (at == state_.divided.end()) return;
  const auto carried = rest_.carried_count();
  for (Index part : at->second.parts)
    for (Index vertex : state_.shown[state_.slot_of[part]])
      if (vertex >= carried && topology.alive(state_.cut[vertex - carried].element))
        state_.cut[vertex - carried].corners = topology.corners(state_.cut[vertex - carried].element);
}

}  // namespace lobe
