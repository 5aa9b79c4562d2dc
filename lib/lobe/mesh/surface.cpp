#include "lobe/mesh/surface.h"

#include <algorithm>
#include <utility>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr std::uint8_t new_face = 255;  // nothing was known of it

Index taken_from(std::vector<Index>& slots) {
  const Index slot = slots.back();
  slots.pop_back();
  return slot;
}

}  // namespace

void Surface::clear(const SurfaceCells& cells) {
  const std::uint64_t revision = mesh_.revision + 1;
  mesh_ = {};
  mesh_.revision = revision;
  of_tets_ = cells.are_tets();
  uses_.clear();
  point_of_.clear();
  within_of_.clear();
  next_of_.clear();
  kind_of_.clear();
  faces_.clear();
  triangle_of_.assign(4 * std::size_t(cells.count()), -1);
  first_of_.assign(std::size_t(cells.point_count()), -1);
}

void Surface::rebuild(const Topology& topology, const TetTags& tags) {
  rebuild(TetCells::since_start(topology), tags);
}

void Surface::rebuild(const SurfaceCells& cells, const TetTags& tags) {
  clear(cells);
  for (Index code : cells.outer_faces()) {
    faces_.push_back(face_of(code, cells.cell(code / 4)));
    find_kind(cells, new_face, faces_.back());
  }
  for (Face& face : faces_) place(cells, face, tags);
  mesh_.changed_triangles.restart(mesh_.revision);
  mesh_.changed_vertices.restart(mesh_.revision);
}

void Surface::follow(const Topology& topology, const MeshEdit& edit, const TetTags& tags) {
  if (edit.empty()) return;
  corners_.clear();
  for (Index t : edit.removed)
    for (Index v : topology.corners(t)) corners_.push_back(v);
  for (const VertexSplit& split : edit.splits) corners_.push_back(split.copy);
  sort_unique(corners_);
  near_ = edit.removed;
  for (Index v : corners_) near_.insert(near_.end(), topology.around(v).begin(), topology.around(v).end());
  follow(TetCells(topology, edit.removed), std::move(near_), tags);
}

void Surface::follow(const SurfaceCells& cells, std::vector<Index> changed, const TetTags& tags) {
  if (changed.empty()) return;
  sort_unique(changed);
  begin_revision();
  triangle_of_.resize(4 * std::size_t(cells.count()), -1);
  first_of_.resize(std::size_t(cells.point_count()), -1);
  faces_.clear();
  for (Index cell : changed) find_changed(cells, cell);

  keep_vertices();
  forget_unused();
  std::sort(free_triangles_.begin(), free_triangles_.end(), std::greater<>());
  for (Face& face : faces_) place(cells, face, tags);
  if (!of_tets_) find_places_anew(cells, changed);
  close_gaps(cells);
}

void Surface::follow_regions(const SurfaceCells& cells, std::span<const Index> tets,
                             std::span<const RegionModel> region_of) {
  bool has_begun = false;
  near_.clear();
  for (Index t : tets) cells.append_cells_of(t, near_);
  for (Index cell : near_)
    for (Index code = 4 * cell; code < 4 * cell + 4; ++code) {
      const Index triangle = triangle_of_[std::size_t(code)];
      if (triangle < 0) continue;
      const RegionModel region = region_of[mesh_.owner[triangle].tet];
      if (mesh_.region[triangle] == region) continue;
      if (!has_begun) begin_revision();
      has_begun = true;
      mesh_.region[triangle] = region;
      mesh_.changed_triangles.record(triangle);
    }
}

Index Surface::code_of(const FaceOwner& owner) const {
  return of_tets_ ? 4 * owner.tet + Index(owner.code) : Index(owner.code);
}

Index Surface::triangle_of(const FaceOwner& face) const {
  if (face.tet < 0 || (of_tets_ && face.code > 3)) return -1;
  const auto code = std::size_t(code_of(face));
  if (code >= triangle_of_.size()) return -1;
  const Index triangle = triangle_of_[code];
  return triangle < 0 || mesh_.owner[triangle] != face ? -1 : triangle;
}

Index Surface::vertex_of(Index point, bool cut, Index stroke) const {
  if (point < 0 || std::size_t(point) >= first_of_.size()) return -1;
  Index vertex = first_of_[point];
  while (vertex >= 0 && kind_of_[vertex] != (cut ? stroke : skin)) vertex = next_of_[vertex];
  return vertex;
}

// Where the number of a vertex is, or will be, in the list of those of its point.
Index& Surface::vertex_in_list(Index point, Kind kind) {
  Index* vertex = &first_of_[point];
  while (*vertex >= 0 && kind_of_[*vertex] != kind) vertex = &next_of_[*vertex];
  return *vertex;
}

// `was`: as in SurfaceMesh::cut, or new_face.
void Surface::find_kind(const SurfaceCells& cells, std::uint8_t was, Face& face) {
  face.kind = cells.is_cut(face.code, was != 0) ? cells.stroke_of(face.code) : skin;
  face.is_burnt = face.kind == burnt && cells.is_burnt(face.code, was == 2);
}

void Surface::begin_revision() {
  ++mesh_.revision;
  mesh_.changed_triangles.next(mesh_.triangles.size());
  mesh_.changed_vertices.next(mesh_.mesh_vertex.size());
}

// Counts that its corners are used by one triangle less.
void Surface::release(Index triangle) {
  for (Index vertex : mesh_.triangles[triangle])
    if (--uses_[vertex] == 0) unused_.push_back(vertex);
}

void Surface::drop(Index code) {
  Index& triangle = triangle_of_[std::size_t(code)];
  if (triangle < 0) return;
  release(triangle);
  free_triangles_.push_back(triangle);
  triangle = -1;
}

Surface::Face Surface::face_of(Index code, const SurfaceCells::Cell& cell) const {
  const int* c = face_corners[code % 4];
  const auto of_owner = std::uint32_t(of_tets_ ? code % 4 : code);
  Face face;
  face.owner = {cell.tet, of_owner};
  face.code = code;
  face.points = {cell.points[c[0]], cell.points[c[1]], cell.points[c[2]]};
  return face;
}

// Drops the faces of a cell that are not outer any more, and adds those to faces_ which the edit has opened,
// or has given other points or another tetrahedron.
void Surface::find_changed(const SurfaceCells& cells, Index cell) {
  const SurfaceCells::Cell found_cell = cells.cell(cell);
  for (Index code = 4 * cell; code < 4 * cell + 4; ++code) {
    if (found_cell.tet < 0 || !(found_cell.outer >> code % 4 & 1)) {
      drop(code);
      continue;
    }
    Face face = face_of(code, found_cell);
    face.triangle = triangle_of_[std::size_t(code)];
    find_kind(cells, face.triangle < 0 ? new_face : mesh_.cut[face.triangle], face);
    if (face.triangle >= 0) {
      if (stays(face)) continue;
      release(face.triangle);
    }
    faces_.push_back(face);
  }
}

bool Surface::stays(const Face& face) const {
  const Eigen::Vector3i& old = mesh_.triangles[face.triangle];
  for (int i = 0; i < 3; ++i)
    if (point_of_[old[i]] != face.points[i]) return false;
  return kind_of_[old[0]] == face.kind && mesh_.owner[face.triangle] == face.owner;
}

// Vertices that are still used keep their slots. So these are marked before any slot is given away.
void Surface::keep_vertices() {
  for (Face& face : faces_)
    for (int i = 0; i < 3; ++i) {
      face.vertices[i] = vertex_in_list(face.points[i], face.kind);
      if (face.vertices[i] >= 0) ++uses_[face.vertices[i]];
    }
}

void Surface::forget_unused() {
  std::erase_if(unused_, [&](Index vertex) { return uses_[vertex] > 0; });
  std::sort(unused_.begin(), unused_.end(), std::greater<>());
  for (Index vertex : unused_) vertex_in_list(point_of_[vertex], kind_of_[vertex]) = next_of_[vertex];
}

Index Surface::vertex_for(const SurfaceCells& cells, Index point, Kind kind) {
  if (const Index known = vertex_in_list(point, kind); known >= 0) return known;
  Index vertex = mesh_.vertex_count();
  if (!unused_.empty()) {
    vertex = taken_from(unused_);
  } else {
    mesh_.mesh_vertex.emplace_back();
    mesh_.vertex_cut.emplace_back();
    point_of_.emplace_back();
    within_of_.push_back(-1);
    next_of_.emplace_back();
    kind_of_.emplace_back();
    uses_.push_back(0);
  }
  vertex_in_list(point, kind) = vertex;
  next_of_[vertex] = -1;
  kind_of_[vertex] = kind;
  point_of_[vertex] = point;
  mesh_.vertex_cut[vertex] = kind != skin;
  put(vertex, cells.place(point));
  mesh_.changed_vertices.record(vertex);
  return vertex;
}

void Surface::put(Index vertex, const SurfacePlace& place) {
  if (place.vertex >= 0) {
    mesh_.mesh_vertex[vertex] = place.vertex;
    return take_out(vertex);
  }
  Index nearest = 0;
  place.weights.maxCoeff(&nearest);
  mesh_.mesh_vertex[vertex] = place.corners[nearest];
  if (within_of_[vertex] < 0) {
    within_of_[vertex] = static_cast<Index>(mesh_.within.size());
    mesh_.within.emplace_back();
  }
  mesh_.within[within_of_[vertex]] = {vertex, place.corners, place.weights};
}

// Takes a vertex out of the list of those that lie within tetrahedra.
void Surface::take_out(Index vertex) {
  const Index at = std::exchange(within_of_[vertex], -1);
  if (at < 0) return;
  mesh_.within[at] = mesh_.within.back();
  mesh_.within.pop_back();
  if (std::size_t(at) < mesh_.within.size()) within_of_[mesh_.within[at].vertex] = at;
}

// Finds the places of points again whose tetrahedra have other vertices, or that new points have changed.
void Surface::find_places_anew(const SurfaceCells& cells, std::span<const Index> changed) {
  corners_.clear();
  for (Index cell : changed)
    if (const SurfaceCells::Cell found_cell = cells.cell(cell); found_cell.tet >= 0)
      corners_.insert(corners_.end(), found_cell.points.begin(), found_cell.points.end());
  sort_unique(corners_);
  for (Index point : corners_)
    for (Index vertex = first_of_[point]; vertex >= 0; vertex = next_of_[vertex]) {
      put(vertex, cells.place(point));
      mesh_.changed_vertices.record(vertex);
    }
}

void Surface::place(const SurfaceCells& cells, Face& face, const TetTags& tags) {
  for (int i = 0; i < 3; ++i) {
    if (face.vertices[i] >= 0) continue;
    face.vertices[i] = vertex_for(cells, face.points[i], face.kind);
    ++uses_[face.vertices[i]];
  }
  if (face.triangle < 0 && !free_triangles_.empty()) face.triangle = taken_from(free_triangles_);
  if (face.triangle < 0) {
    face.triangle = mesh_.triangle_count();
    mesh_.triangles.emplace_back();
    mesh_.owner.emplace_back();
    mesh_.region.emplace_back();
    mesh_.body.emplace_back();
    mesh_.cut.emplace_back();
  }
  mesh_.triangles[face.triangle] = face.vertices;
  mesh_.owner[face.triangle] = face.owner;
  mesh_.region[face.triangle] = tags.region(face.owner.tet);
  mesh_.body[face.triangle] = tags.body(face.owner.tet);
  mesh_.cut[face.triangle] = face.kind == skin ? 0 : face.is_burnt ? 2 : 1;
  triangle_of_[std::size_t(face.code)] = face.triangle;
  mesh_.changed_triangles.record(face.triangle);
}

// Moves the last triangle to the slot `to`, which is free.
void Surface::move_triangle(Index to) {
  const Index last = mesh_.triangle_count() - 1;
  if (to != last) {
    mesh_.triangles[to] = mesh_.triangles[last];
    mesh_.owner[to] = mesh_.owner[last];
    mesh_.region[to] = mesh_.region[last];
    mesh_.body[to] = mesh_.body[last];
    mesh_.cut[to] = mesh_.cut[last];
    triangle_of_[std::size_t(code_of(mesh_.owner[to]))] = to;
    mesh_.changed_triangles.record(to);
  }
  mesh_.triangles.pop_back();
  mesh_.owner.pop_back();
  mesh_.region.pop_back();
  mesh_.body.pop_back();
  mesh_.cut.pop_back();
}

// Moves the last vertex to the slot `to`, which nothing uses. Its triangles are those of the cells around it.
void Surface::move_vertex(const SurfaceCells& cells, Index to) {
  const Index last = mesh_.vertex_count() - 1;
  take_out(to);
  if (to != last) {
    const Index point = point_of_[last];
    vertex_in_list(point, kind_of_[last]) = to;
    next_of_[to] = next_of_[last];
    kind_of_[to] = kind_of_[last];
    point_of_[to] = point;
    mesh_.mesh_vertex[to] = mesh_.mesh_vertex[last];
    mesh_.vertex_cut[to] = mesh_.vertex_cut[last];
    uses_[to] = uses_[last];
    within_of_[to] = within_of_[last];
    if (within_of_[to] >= 0) mesh_.within[within_of_[to]].vertex = to;
    mesh_.changed_vertices.record(to);
    for (Index cell : cells.around(point))
      for (Index code = 4 * cell; code < 4 * cell + 4; ++code) {
        const Index triangle = triangle_of_[std::size_t(code)];
        if (triangle < 0 || (mesh_.triangles[triangle].array() != last).all()) continue;
        for (Index& vertex : mesh_.triangles[triangle])
          if (vertex == last) vertex = to;
        mesh_.changed_triangles.record(triangle);
      }
  }
  mesh_.mesh_vertex.pop_back();
  mesh_.vertex_cut.pop_back();
  point_of_.pop_back();
  within_of_.pop_back();
  next_of_.pop_back();
  kind_of_.pop_back();
  uses_.pop_back();
}

// Fills the highest slots first, so that the last entry is never in a free slot itself.
void Surface::close_gaps(const SurfaceCells& cells) {
  for (Index triangle : free_triangles_) move_triangle(triangle);
  for (Index vertex : unused_) move_vertex(cells, vertex);
  free_triangles_.clear();
  unused_.clear();
}

}  // namespace lobe
