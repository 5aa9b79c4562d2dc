#include "lobe/mesh/edges.h"

#include <algorithm>

#include "lobe/sort_unique.h"

namespace lobe {

MeshEdge mesh_edge(const TetMesh& mesh, Index tet, int e) {
  const auto [low, high] =
      std::minmax({mesh.tets(edge_corners[e][0], tet), mesh.tets(edge_corners[e][1], tet)});
  return {low, high};
}

std::vector<MeshEdge> mesh_edges(const TetMesh& mesh) {
  std::vector<MeshEdge> edges;
  edges.reserve(6 * std::size_t(mesh.tet_count()));
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (int e = 0; e < 6; ++e) edges.push_back(mesh_edge(mesh, t, e));
  sort_unique(edges);
  return edges;
}

Index edge_number(const std::vector<MeshEdge>& edges, const MeshEdge& edge) {
  return static_cast<Index>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
}

}  // namespace lobe
