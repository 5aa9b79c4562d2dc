// How deep the bodies of a mesh lie in each other.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct BodyOverlap {
  int body = 0, other = 0;      // body < other
  double depth = 0;             // [m]
  Vec3d place = Vec3d::Zero();  // the deepest point [m]
  double edge = 0;              // the smaller one of their mean edges [m]
};

// Each pair of bodies that overlap by more than rounding. Looked at are vertices, middles of edges and
// centres of faces of one body's surface in the other body. O(#surface log #tets), and more where they
// overlap.
std::vector<BodyOverlap> body_overlaps(const TetMesh& mesh);

}  // namespace lobe
