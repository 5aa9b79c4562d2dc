#include "lobe/solve/quadratic_mesh.h"

namespace lobe {

QuadraticMesh::QuadraticMesh(const TetMesh& mesh)
    : vertices(mesh.vertex_count()), ends(mesh_edges(mesh)), nodes(10, mesh.tet_count()) {
  nodes.topRows<4>() = mesh.tets;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (int e = 0; e < 6; ++e) nodes(4 + e, t) = vertices + edge_number(ends, mesh_edge(mesh, t, e));
}

}  // namespace lobe
