// Uniform refinement: a mesh of half the edge length of the same body.
#pragma once

#include <array>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct RefinedMesh {
  TetMesh mesh;                            // the old vertices keep their numbers; new ones come after them
  std::vector<Index> parent_of;            // parent of each tetrahedron; t has the children 8 t … 8 t + 7
  std::vector<std::array<Index, 2>> ends;  // ends of the old edge in whose middle each new vertex lies

  // A P1 field of the old mesh, #components × #old vertices, as one of the new mesh, without any change.
  template <class Field>
  Field prolongate(const Field& old) const {
    Field fine(old.rows(), mesh.vertex_count());
    fine.leftCols(old.cols()) = old;
    for (std::size_t i = 0; i < ends.size(); ++i)
      fine.col(old.cols() + Eigen::Index(i)) = (old.col(ends[i][0]) + old.col(ends[i][1])) / 2;
    return fine;
  }
  // A field of the old tetrahedra, #components × #old tetrahedra: children have their parent's values.
  template <class Field>
  Field inherit(const Field& old) const {
    Field fine(old.rows(), mesh.tet_count());
    for (Index t = 0; t < mesh.tet_count(); ++t) fine.col(t) = old.col(parent_of[std::size_t(t)]);
    return fine;
  }
};

// Each tetrahedron becomes eight (red refinement: J. Bey, Computing 55, 1995): one at each corner, and the
// octahedron between them cut into four along the shortest of its diagonals. Conforming, positively oriented,
// labels kept. Throws InputError beyond 2^31 − 1 tetrahedra, and if only some tetrahedra have a label.
// O(#tetrahedra log #tetrahedra).
RefinedMesh refine(const TetMesh& mesh);

}  // namespace lobe
