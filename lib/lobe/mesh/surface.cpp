#include "lobe/mesh/surface.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using FaceAtStart = std::array<Index, 3>;  // vertices of the mesh at the start, ascending

FaceAtStart key_at_start(const Topology& topology, const Eigen::Vector3i& face) {
  FaceAtStart key{topology.origin(face[0]), topology.origin(face[1]), topology.origin(face[2])};
  std::sort(key.begin(), key.end());
  return key;
}

// Faces of the tetrahedra that are gone: what lies behind one of them was inside.
std::vector<FaceAtStart> faces_of_removed(const Topology& topology) {
  std::vector<FaceAtStart> faces;
  if (topology.alive_count() == topology.tet_count()) return faces;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (!topology.alive(t))
      for (int f = 0; f < 4; ++f) faces.push_back(key_at_start(topology, topology.face(4 * t + f)));
  std::sort(faces.begin(), faces.end());
  return faces;
}

Index taken_from(std::vector<Index>& slots) {
  const Index slot = slots.back();
  slots.pop_back();
  return slot;
}

}  // namespace

void Surface::rebuild(const Topology& topology, std::span<const RegionModel> region_of) {
  const std::uint64_t revision = mesh_.revision + 1;
  mesh_ = {};
  mesh_.revision = revision;
  uses_.clear();
  triangle_of_.assign(4 * std::size_t(topology.tet_count()), -1);
  vertex_of_.assign(std::size_t(topology.vertex_count()), {-1, -1});
  faces_.clear();
  const std::vector<FaceAtStart> gone = faces_of_removed(topology);
  for (Index code : topology.boundary_faces()) {
    const Eigen::Vector3i corners = topology.face(code);
    const bool cut = std::binary_search(gone.begin(), gone.end(), key_at_start(topology, corners));
    faces_.push_back({{code / 4, std::uint32_t(code % 4)}, -1, cut, corners});
  }
  for (Face& face : faces_) place(face, region_of[face.owner.tet]);
  mesh_.changed_triangles.restart(revision);
  mesh_.changed_vertices.restart(revision);
}

void Surface::follow(const Topology& topology, const MeshEdit& edit, std::span<const RegionModel> region_of) {
  if (edit.empty()) return;
  begin_revision();
  triangle_of_.resize(4 * std::size_t(topology.tet_count()), -1);
  vertex_of_.resize(std::size_t(topology.vertex_count()), {-1, -1});
  faces_.clear();
  corners_.clear();
  for (Index t : edit.removed) {
    for (std::uint32_t f = 0; f < 4; ++f) drop({t, f});
    for (Index v : topology.corners(t)) corners_.push_back(v);
  }
  for (const VertexSplit& split : edit.splits) corners_.push_back(split.copy);
  sort_unique(corners_);
  near_.clear();
  for (Index v : corners_) near_.insert(near_.end(), topology.around(v).begin(), topology.around(v).end());
  sort_unique(near_);
  for (Index t : near_) find_changed(topology, t);

  keep_vertices();
  forget_unused();
  std::sort(free_triangles_.begin(), free_triangles_.end(), std::greater<>());
  for (Face& face : faces_) place(face, region_of[face.owner.tet]);
  close_gaps(topology);
}

void Surface::follow_regions(std::span<const Index> tets, std::span<const RegionModel> region_of) {
  bool has_begun = false;
  for (Index t : tets)
    for (std::uint32_t f = 0; f < 4; ++f) {
      const Index triangle = triangle_of({t, f});
      if (triangle < 0 || mesh_.region[triangle] == region_of[t]) continue;
      if (!has_begun) begin_revision();
      has_begun = true;
      mesh_.region[triangle] = region_of[t];
      mesh_.changed_triangles.record(triangle);
    }
}

Index Surface::triangle_of(const FaceOwner& face) const {
  const std::size_t at = 4 * std::size_t(face.tet) + face.code;
  return face.tet < 0 || face.code > 3 || at >= triangle_of_.size() ? -1 : triangle_of_[at];
}

Index Surface::vertex_of(Index mesh_vertex, bool cut) const {
  if (mesh_vertex < 0 || std::size_t(mesh_vertex) >= vertex_of_.size()) return -1;
  return vertex_of_[mesh_vertex][cut];
}

void Surface::begin_revision() {
  ++mesh_.revision;
  mesh_.changed_triangles.next(mesh_.triangles.size());
  mesh_.changed_vertices.next(mesh_.mesh_vertex.size());
}

// Its corners are used once less.
void Surface::release(Index triangle) {
  for (Index vertex : mesh_.triangles[triangle])
    if (--uses_[vertex] == 0) unused_.push_back(vertex);
}

void Surface::drop(const FaceOwner& face) {
  Index& triangle = triangle_at(face);
  if (triangle < 0) return;
  release(triangle);
  free_triangles_.push_back(triangle);
  triangle = -1;
}

// Adds those faces of an alive tetrahedron to faces_ which the edit has opened, or has given other corners.
void Surface::find_changed(const Topology& topology, Index tet) {
  for (int f = 0; f < 4; ++f) {
    if (topology.neighbour(tet, f) >= 0) continue;
    Face face{{tet, std::uint32_t(f)}, -1, 1, topology.face(4 * tet + f)};
    face.triangle = triangle_at(face.owner);
    if (face.triangle >= 0) {
      const Eigen::Vector3i& old = mesh_.triangles[face.triangle];
      const auto stays = [&](int i) { return mesh_.mesh_vertex[old[i]] == face.mesh_vertices[i]; };
      if (stays(0) && stays(1) && stays(2)) continue;
      face.cut = mesh_.cut[face.triangle];
      release(face.triangle);
    }
    faces_.push_back(face);
  }
}

// Vertices that go on being used keep their slots: they are claimed before any is given away.
void Surface::keep_vertices() {
  for (Face& face : faces_)
    for (int i = 0; i < 3; ++i) {
      face.vertices[i] = vertex_of_[face.mesh_vertices[i]][face.cut];
      if (face.vertices[i] >= 0) ++uses_[face.vertices[i]];
    }
}

void Surface::forget_unused() {
  std::erase_if(unused_, [&](Index vertex) { return uses_[vertex] > 0; });
  std::sort(unused_.begin(), unused_.end(), std::greater<>());
  for (Index vertex : unused_) vertex_of_[mesh_.mesh_vertex[vertex]][mesh_.vertex_cut[vertex]] = -1;
}

Index Surface::vertex_for(Index mesh_vertex, std::uint8_t cut) {
  Index& vertex = vertex_of_[mesh_vertex][cut];
  if (vertex >= 0) return vertex;
  if (!unused_.empty()) {
    vertex = taken_from(unused_);
  } else {
    vertex = mesh_.vertex_count();
    mesh_.mesh_vertex.emplace_back();
    mesh_.vertex_cut.emplace_back();
    uses_.push_back(0);
  }
  mesh_.mesh_vertex[vertex] = mesh_vertex;
  mesh_.vertex_cut[vertex] = cut;
  mesh_.changed_vertices.record(vertex);
  return vertex;
}

void Surface::place(Face& face, RegionModel region) {
  for (int i = 0; i < 3; ++i) {
    if (face.vertices[i] >= 0) continue;
    face.vertices[i] = vertex_for(face.mesh_vertices[i], face.cut);
    ++uses_[face.vertices[i]];
  }
  if (face.triangle < 0 && !free_triangles_.empty()) face.triangle = taken_from(free_triangles_);
  if (face.triangle < 0) {
    face.triangle = mesh_.triangle_count();
    mesh_.triangles.emplace_back();
    mesh_.owner.emplace_back();
    mesh_.region.emplace_back();
    mesh_.cut.emplace_back();
  }
  mesh_.triangles[face.triangle] = face.vertices;
  mesh_.owner[face.triangle] = face.owner;
  mesh_.region[face.triangle] = region;
  mesh_.cut[face.triangle] = face.cut;
  triangle_at(face.owner) = face.triangle;
  mesh_.changed_triangles.record(face.triangle);
}

// The last triangle takes the slot `to`, which is free.
void Surface::move_triangle(Index to) {
  const Index last = mesh_.triangle_count() - 1;
  if (to != last) {
    mesh_.triangles[to] = mesh_.triangles[last];
    mesh_.owner[to] = mesh_.owner[last];
    mesh_.region[to] = mesh_.region[last];
    mesh_.cut[to] = mesh_.cut[last];
    triangle_at(mesh_.owner[to]) = to;
    mesh_.changed_triangles.record(to);
  }
  mesh_.triangles.pop_back();
  mesh_.owner.pop_back();
  mesh_.region.pop_back();
  mesh_.cut.pop_back();
}

// The last vertex takes the slot `to`, which nothing uses. Its triangles are those of tetrahedra around it.
void Surface::move_vertex(const Topology& topology, Index to) {
  const Index last = mesh_.vertex_count() - 1;
  if (to != last) {
    const Index mesh_vertex = mesh_.mesh_vertex[last];
    mesh_.mesh_vertex[to] = mesh_vertex;
    mesh_.vertex_cut[to] = mesh_.vertex_cut[last];
    uses_[to] = uses_[last];
    vertex_of_[mesh_vertex][mesh_.vertex_cut[to]] = to;
    mesh_.changed_vertices.record(to);
    for (Index t : topology.around(mesh_vertex))
      for (std::uint32_t f = 0; f < 4; ++f) {
        const Index triangle = triangle_at({t, f});
        if (triangle < 0 || (mesh_.triangles[triangle].array() != last).all()) continue;
        for (Index& vertex : mesh_.triangles[triangle])
          if (vertex == last) vertex = to;
        mesh_.changed_triangles.record(triangle);
      }
  }
  mesh_.mesh_vertex.pop_back();
  mesh_.vertex_cut.pop_back();
  uses_.pop_back();
}

// Highest slots first, so that the last one is never free itself.
void Surface::close_gaps(const Topology& topology) {
  for (Index triangle : free_triangles_) move_triangle(triangle);
  for (Index vertex : unused_) move_vertex(topology, vertex);
  free_triangles_.clear();
  unused_.clear();
}

template <class Real>
void update_positions(const SurfaceMesh& surface, const Eigen::Ref<const Mat3X<double>>& X,
                      const Eigen::Ref<const Mat3X<std::type_identity_t<Real>>>& u, Mat3X<Real>& x) {
  x.resize(3, surface.vertex_count());
  for (Index i = 0; i < surface.vertex_count(); ++i) {
    const Index v = surface.mesh_vertex[i];
    x.col(i) = (X.col(v) + u.col(v).template cast<double>()).template cast<Real>();
  }
}

template <class Real>
void update_normals(const SurfaceMesh& surface, const Mat3X<Real>& x, Mat3X<Real>& normals) {
  normals.setZero(3, surface.vertex_count());
  for (const Eigen::Vector3i& t : surface.triangles) {
    const Vec3<Real> a = x.col(t[0]);
    const Vec3<Real> twice_area = (x.col(t[1]) - a).cross(x.col(t[2]) - a);
    for (Index vertex : t) normals.col(vertex) += twice_area;
  }
  for (auto normal : normals.colwise()) normal.normalize();
}

double enclosed_volume(const SurfaceMesh& surface, const Mat3X<double>& x) {
  double six_volumes = 0;
  for (const Eigen::Vector3i& t : surface.triangles)
    six_volumes += x.col(t[0]).dot(x.col(t[1]).cross(x.col(t[2])));
  return six_volumes / 6;
}

#define LOBE_INSTANTIATE(Real)                                                                     \
  template void update_positions<Real>(const SurfaceMesh&, const Eigen::Ref<const Mat3X<double>>&, \
                                       const Eigen::Ref<const Mat3X<Real>>&, Mat3X<Real>&);        \
  template void update_normals<Real>(const SurfaceMesh&, const Mat3X<Real>&, Mat3X<Real>&);
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
