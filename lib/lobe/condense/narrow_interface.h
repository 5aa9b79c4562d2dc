// Finds where a pre-computed region should end, so that its interface has as few vertices as possible. A step
// costs the square of their number.
#pragma once

#include <cstdint>
#include <vector>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

enum class Side : std::uint8_t { linear, either, nonlinear };

// Gives each tetrahedron that may be on either side to one of them, so that as few vertices as possible
// belong to both: a minimum cut through vertices, found by as many paths without a common vertex as there are
// (K. Menger 1927). Afterwards no tetrahedron is `either`. O(shared vertices × tetrahedra that may be on
// either side).
std::vector<Side> with_narrow_interface(const TetMesh& mesh, std::vector<Side> sides);  // per tetrahedron

}  // namespace lobe
