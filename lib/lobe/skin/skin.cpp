#include "lobe/skin/skin.h"

#include <algorithm>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

void append(std::vector<Index>& to, std::span<const Index> items) {
  to.insert(to.end(), items.begin(), items.end());
}

}  // namespace

TexturedSurface textured_boundary(const TetMesh& mesh) {
  const Topology topology(mesh);
  TexturedSurface surface;
  surface.points = mesh.points;
  surface.triangles.resize(3, Eigen::Index(topology.boundary_faces().size()));
  for (std::size_t i = 0; i < topology.boundary_faces().size(); ++i)
    surface.triangles.col(Eigen::Index(i)) = topology.face(topology.boundary_faces()[i]);
  surface.texture_of = surface.normal_of = Triangles::Constant(3, surface.triangles.cols(), -1);
  return surface;
}

Skin::Skin(const TexturedSurface& surface, const TetMesh& mesh)
    : rest_(bind(surface, mesh, mesh_)), frame_(rest_) {
  for (Index triangle = 0; triangle < rest_.file_count(); ++triangle) {
    state_.slot_of.push_back(triangle);
    state_.number_of.push_back(triangle);
    state_.shown.push_back(rest_.corners.col(triangle));
  }
  choose_carriers(Topology(rest_.start));
  state_.slot_of.push_back(-1);  // of the triangle of no area
  mesh_.revision = 1;
  mesh_.changed_triangles.restart(1);
  mesh_.changed_vertices.restart(1);
}

void Skin::choose_carriers(const Topology& topology) {
  const Eigen::Index count = rest_.points.cols();
  state_.carrier.assign(std::size_t(count), -1);
  state_.element = state_.carrier;
  state_.weights.resize(std::size_t(count));
  state_.carrier_corners.resize(std::size_t(count));
  std::vector<Index> lengths(std::size_t(rest_.start.tet_count()), 0);
  std::vector<Index> chosen;
  for (Index vertex = 0; vertex < count; ++vertex) {
    chosen.push_back(nearest_of(candidates(vertex), rest_.start, rest_.points.col(vertex)));
    ++lengths[chosen.back()];
  }
  state_.carried_by = VertexLists<Index>(lengths);
  for (Index vertex = 0; vertex < count; ++vertex) {
    carry(vertex, chosen[vertex], topology);
    farthest_ = std::max(farthest_,
                         distance_to_tet(rest_.points.col(vertex), tet_points(rest_.start, chosen[vertex])));
  }
  is_loose_.assign(state_.slot_of.size(), 0);
  for (Index triangle = 0; triangle < rest_.file_count(); ++triangle)
    is_loose_[triangle] = bond_of(topology, triangle, rest_.corners_in(triangle)) != Bond::firm;
}

Index Skin::loose_count() const {
  return static_cast<Index>(std::count(is_loose_.begin(), is_loose_.end(), 1));
}

// The tetrahedra under the shown triangles around a vertex, and under those of which parts are shown.
std::vector<Index> Skin::candidates(Index vertex) const {
  std::vector<Index> tets;
  for (Index triangle : rest_.around[vertex])
    if (state_.slot_of[triangle] >= 0 || state_.divided.contains(triangle))
      append(tets, rest_.lies_on[triangle]);
  return tets;
}

void Skin::carry(Index vertex, Index element, const Topology& topology) {
  const Index tet = topology.parent(element);
  if (state_.carrier[vertex] >= 0) state_.carried_by.erase_value(state_.carrier[vertex], vertex);
  state_.carried_by.append(tet, vertex);
  state_.carrier[vertex] = tet;
  state_.element[vertex] = element;
  state_.carrier_corners[vertex] = topology.corners(element);
  state_.weights[vertex] = barycentric(rest_.start, tet, rest_.points.col(vertex)).cast<float>();
}

void Skin::follow(const Topology& topology, const MeshEdit& edit, const Grains* grains) {
  std::vector<Index> triangles, vertices, cut;
  const auto touched = [&](Index element) {
    const Index tet = topology.parent(element);
    append(triangles, rest_.lying_on[tet]);
    append(vertices, state_.carried_by[tet]);
    for (Index vertex : state_.carried_by[tet])
      if (topology.alive(state_.element[vertex]))
        state_.carrier_corners[vertex] = topology.corners(state_.element[vertex]);
  };
  for (Index t : edit.removed) touched(t);
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) touched(t);
  for (const TetCopy& tet_copy : edit.copies)
    state_.copies_of[topology.parent(tet_copy.copy)].push_back(tet_copy.copy);
  for (const TetShare& tet_share : edit.shares) {
    touched(tet_share.tet);
    cut.push_back(topology.parent(tet_share.tet));
  }
  follow(topology, triangles, vertices, cut, grains);
}

void Skin::follow_all(const Topology& topology, const Grains* grains) {
  std::vector<Index> triangles, vertices, cut;
  state_.copies_of.clear();
  for (Index t = rest_.start.tet_count(); t < topology.tet_count(); ++t) {
    state_.copies_of[topology.parent(t)].push_back(t);
    cut.push_back(topology.parent(t));
  }
  for (Index vertex = 0; vertex < rest_.points.cols(); ++vertex) {
    vertices.push_back(vertex);
    if (topology.alive(state_.element[vertex]))
      state_.carrier_corners[vertex] = topology.corners(state_.element[vertex]);
  }
  for (Index triangle = 0; triangle < rest_.file_count(); ++triangle) triangles.push_back(triangle);
  follow(topology, triangles, vertices, cut, grains);
}

void Skin::follow(const Topology& topology, std::vector<Index>& triangles, std::vector<Index>& vertices,
                  std::vector<Index>& cut, const Grains* grains) {
  sort_unique(vertices);
  if (!grains) return check(topology, triangles, vertices);
  has_new_revision_ = false;
  sort_unique(cut);
  follow_grains({topology, *grains}, cut);
  open({topology, *grains}, triangles, vertices);
}

// Hides triangles that have lost tetrahedra under them, then chooses new carriers, then hides triangles whose
// carriers are not connected.
void Skin::check(const Topology& topology, std::vector<Index>& triangles,
                 const std::vector<Index>& vertices) {
  std::vector<Index> drops;
  const auto collect = [&](auto&& stays) {
    sort_unique(triangles);
    for (Index triangle : triangles)
      if (state_.slot_of[triangle] >= 0 && !stays(triangle)) drops.push_back(triangle);
  };
  collect([&](Index triangle) { return bond_of(topology, triangle, {}) != Bond::none; });
  drop(drops);
  for (Index vertex : vertices) {
    append(triangles, rest_.around[vertex]);
    if (holds_to_any(topology, vertex)) continue;
    const Index tet = nearest_of(candidates(vertex), rest_.start, rest_.points.col(vertex));
    if (tet >= 0) carry(vertex, tet, topology);
  }
  collect([&](Index triangle) { return holds(topology, triangle, rest_.corners_in(triangle)); });
  drop(drops);
}

// The bond of the tetrahedra under a triangle and those that carry some of its corners.
Bond Skin::bond_of(const Topology& topology, Index triangle, std::span<const Index> corners) const {
  const std::span<const Index> under = rest_.lies_on[triangle];
  std::vector<Index> tets(under.begin(), under.end());
  for (Index vertex : corners)
    if (std::find(tets.begin(), tets.end(), state_.element[vertex]) == tets.end())
      tets.push_back(state_.element[vertex]);
  return bond(topology, tets);
}

bool Skin::holds(const Topology& topology, Index triangle, std::span<const Index> corners) const {
  const Bond found = bond_of(topology, triangle, corners);
  return found == Bond::firm || (found == Bond::loose && is_loose_[triangle]);
}

// Whether the tetrahedron that carries a vertex is connected with those under a shown triangle around it.
bool Skin::holds_to_any(const Topology& topology, Index vertex) const {
  const std::span<const Index> around = rest_.around[vertex];
  return std::any_of(around.begin(), around.end(), [&](Index triangle) {
    return state_.slot_of[triangle] >= 0 && holds(topology, triangle, {&vertex, 1});
  });
}

// Removes triangles. The last ones take their slots, highest slots first.
void Skin::drop(std::vector<Index>& triangles) {
  if (triangles.empty()) return;
  has_new_revision_ = false;
  begin_revision();
  std::sort(triangles.begin(), triangles.end(),
            [&](Index a, Index b) { return state_.slot_of[a] > state_.slot_of[b]; });
  for (Index triangle : triangles) take_out(triangle);
  triangles.clear();
}

void Skin::update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<float>>& u,
                  Mat3X<float>& x, Mat3X<float>& normals) {
  frame_.update<float>(rest_, state_, mesh_, X, u, x, normals);
}

void Skin::update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<double>>& u,
                  Mat3X<float>& x, Mat3X<float>& normals) {
  frame_.update<double>(rest_, state_, mesh_, X, u, x, normals);
}

}  // namespace lobe
