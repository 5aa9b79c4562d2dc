// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <map>
#include <set>

#include "lobe/mesh/quality.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

std::vector<bool> boundary_vertices(const TetMesh& mesh) {
  std::map<std::array<Index, 3>, std::array<Index, 3>> single;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (const auto& face : face_corners) {
      const std::array<Index, 3> corners{mesh.tets(face[0], t), mesh.tets(face[1], t), mesh.tets(face[2], t)};
      auto key = corners;
      std::sort(key.begin(), key.end());
      if (!single.insert({key, corners}).second) single.erase(key);
    }
  }
  std::vector<bool> on_boundary(mesh.vertex_count(), false);
  for (const auto& [key, corners] : single) {
    for (const Index v : corners) on_boundary[v] = true;
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

}  // namespace lobe::meshing
