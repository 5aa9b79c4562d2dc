// Two meshes as one, without a common vertex.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe::test {

inline TetMesh joined(const TetMesh& a, const TetMesh& b) {
  TetMesh both = a;
  both.points.conservativeResize(3, a.vertex_count() + b.vertex_count());
  both.points.rightCols(b.vertex_count()) = b.points;
  both.tets.conservativeResize(4, a.tet_count() + b.tet_count());
  both.tets.rightCols(b.tet_count()) = b.tets.array() + a.vertex_count();
  both.labels.insert(both.labels.end(), b.labels.begin(), b.labels.end());
  return both;
}

}  // namespace lobe::test
