// The surface of a mesh.
#pragma once

#include <vector>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct TetFace {
  Index tet = 0;
  int face = 0;  // the corner opposite to the face
  bool operator==(const TetFace&) const = default;
};

// Faces that belong to exactly one tetrahedron, ordered by tetrahedron and face.
std::vector<TetFace> outer_faces(const TetMesh& mesh);

}  // namespace lobe
