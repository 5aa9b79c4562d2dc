// By what share a selection holds the vertices of a mesh, so that it holds the same body on every mesh.
//
// A vertex has the quarters of its tetrahedra that are nearest to it by barycentric coordinates, or by area
// the thirds of its boundary faces. Its share is that of them that lies in the selection. It is found at 512
// points of each tetrahedron, or 256 of each face.
#pragma once

#include <string>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe {

struct SelectedShare {
  Index vertex = 0;
  double share = 0;  // above 0; 1 from `wholly_from` on
};
// A spring for a larger share would be as stiff as what is held.
inline constexpr double wholly_from = 0.95;

// Ascending by vertex. Throws InputError for a selector that names vertices, which have no extent, for a
// surface if shares are of the volume, and as select_vertices() does; `place` is the selector's JSON pointer.
// `by` is not HoldBy::vertices.
std::vector<SelectedShare> select_shares(const Selector& selector, const TetMesh& mesh, HoldBy by,
                                         const std::string& place = "");

}  // namespace lobe
