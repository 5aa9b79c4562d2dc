// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "lobe/mesh/quality.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Face = std::array<Index, 3>;

Face sorted_face(const TetMesh& mesh, Index t, int opposite) {
  Face face{mesh.tets(face_corners[opposite][0], t), mesh.tets(face_corners[opposite][1], t),
            mesh.tets(face_corners[opposite][2], t)};
  std::sort(face.begin(), face.end());
  return face;
}

// Faces of one tetrahedron only.
std::set<Face> boundary_faces(const TetMesh& mesh) {
  std::set<Face> single;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const auto [entry, is_new] = single.insert(sorted_face(mesh, t, k));
      if (!is_new) single.erase(entry);
    }
  }
  return single;
}

std::vector<bool> boundary_vertices(const TetMesh& mesh) {
  std::vector<bool> on_boundary(mesh.vertex_count(), false);
  for (const Face& face : boundary_faces(mesh)) {
    for (const Index v : face) on_boundary[v] = true;
  }
  return on_boundary;
}

// Smallest altitude of the tetrahedra at a vertex; negative if one of them is inverted.
double smallest_altitude(const TetMesh& mesh, const std::vector<Index>& tets) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Index t : tets) {
    const Mat34<double> corners = tet_points(mesh, t);
    if (!(signed_volume(corners) > 0)) return -1;
    const auto heights = altitudes(corners);
    smallest = std::min(smallest, *std::min_element(heights.begin(), heights.end()));
  }
  return smallest;
}

void improve(TetMesh& mesh, Index v, const std::vector<Index>& tets) {
  std::set<Index> neighbours;
  for (const Index t : tets) {
    for (int k = 0; k < 4; ++k) neighbours.insert(mesh.tets(k, t));
  }
  neighbours.erase(v);
  Vec3d centre = Vec3d::Zero();
  for (const Index w : neighbours) centre += mesh.points.col(w) / static_cast<double>(neighbours.size());
  const Vec3d old = mesh.points.col(v);
  const double before = smallest_altitude(mesh, tets);
  for (const double step : {1.0, 0.5, 0.25, 0.1}) {
    mesh.points.col(v) = old + step * (centre - old);
    if (smallest_altitude(mesh, tets) > before) return;
  }
  mesh.points.col(v) = old;
}

}  // namespace

void smooth_interior(TetMesh& mesh, int rounds) {
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  std::vector<std::vector<Index>> tets_at(mesh.vertex_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) tets_at[mesh.tets(k, t)].push_back(t);
  }
  for (int round = 0; round < rounds; ++round) {
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if (!on_boundary[v] && !tets_at[v].empty()) improve(mesh, v, tets_at[v]);
    }
  }
}

void peel_flat_tets(TetMesh& mesh) {
  constexpr double flat = 0.03;  // smallest altitude over longest edge
  const std::set<Face> boundary = boundary_faces(mesh);
  std::set<std::pair<Index, Index>> boundary_edges;
  for (const Face& f : boundary) {
    for (const auto& edge : {std::pair{f[0], f[1]}, {f[1], f[2]}, {f[0], f[2]}}) boundary_edges.insert(edge);
  }
  Index kept = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> corners = tet_points(mesh, t);
    const auto heights = altitudes(corners);
    double longest = 0;
    for (const auto& e : edge_corners)
      longest = std::max(longest, (corners.col(e[0]) - corners.col(e[1])).norm());
    std::vector<Index> outer;  // corners opposite to boundary faces: the new edge joins them
    for (int k = 0; k < 4; ++k) {
      if (boundary.contains(sorted_face(mesh, t, k))) outer.push_back(mesh.tets(k, t));
    }
    const bool peel = *std::min_element(heights.begin(), heights.end()) < flat * longest &&
                      outer.size() == 2 && boundary_edges.insert(std::minmax(outer[0], outer[1])).second;
    if (!peel) mesh.tets.col(kept++) = mesh.tets.col(t).eval();
  }
  mesh.tets.conservativeResize(4, kept);
}

}  // namespace lobe::meshing
