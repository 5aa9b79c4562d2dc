// The edges of a mesh.
#pragma once

#include <array>
#include <vector>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

using MeshEdge = std::array<Index, 2>;  // numbers of its vertices, the lower one first

// The edge of a tetrahedron between the corners edge_corners[e].
MeshEdge mesh_edge(const TetMesh& mesh, Index tet, int e);

// Returns each edge once, ascending. O(#tetrahedra log #tetrahedra).
std::vector<MeshEdge> mesh_edges(const TetMesh& mesh);

// Returns where an edge is among all of them.
Index edge_number(const std::vector<MeshEdge>& edges, const MeshEdge& edge);

}  // namespace lobe
