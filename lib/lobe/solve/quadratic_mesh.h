// The mesh of 10-node tetrahedra on a mesh: a node at each vertex, and one in the middle of each edge. Edges
// stay straight.
#pragma once

#include "lobe/mesh/edges.h"

namespace lobe {

struct QuadraticMesh {
  explicit QuadraticMesh(const TetMesh& mesh);

  Index node_count() const { return vertices + static_cast<Index>(ends.size()); }

  // Takes values at the vertices, #components × #vertices, to the nodes: in the middle of an edge their mean.
  template <class Field>
  Field joined_linearly(const Field& at_vertices) const {
    Field at_nodes(at_vertices.rows(), node_count());
    at_nodes.leftCols(vertices) = at_vertices;
    for (std::size_t i = 0; i < ends.size(); ++i)
      at_nodes.col(vertices + Eigen::Index(i)) =
          (at_vertices.col(ends[i][0]) + at_vertices.col(ends[i][1])) / 2;
    return at_nodes;
  }

  Index vertices = 0;  // nodes from 0 on are the vertices of the mesh, by their numbers
  // The ends of the edge of each further node. refine() gives its new vertices the same order.
  std::vector<MeshEdge> ends;
  // Nodes of each tetrahedron: its corners, then its edges in the order of edge_corners.
  Eigen::Matrix<Index, 10, Eigen::Dynamic> nodes;
};

}  // namespace lobe
