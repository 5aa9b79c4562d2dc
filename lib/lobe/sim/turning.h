// Pieces that hang by one vertex, or by several in a line, and will turn about them.
#pragma once

#include "lobe/body/model.h"

namespace lobe {

// The tensor-mass tetrahedra of such pieces that an edit has cut off or left: turned far, they would grow, as what
// is loose would. O(tetrahedra of the pieces that were cut off), and of what is left until three of its held
// vertices are found, where a held piece was cut off from it or all tetrahedra around a held vertex are gone.
std::vector<Index> turning_tets(Model& model, const MeshEdit& edit);

}  // namespace lobe
