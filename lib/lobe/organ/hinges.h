// Finds pieces that hang by one vertex, or by several vertices in a line. Such a piece will turn about them.
#pragma once

#include "lobe/body/model.h"

namespace lobe {

// Returns the tensor-mass tetrahedra of such pieces, cut off by this edit or left by it. They must not stay
// linear: a linear piece that turns far grows. Costs O(tetrahedra of the pieces that were cut off). If a held
// piece was cut off, or all tetrahedra around a held vertex are gone, it also costs a search for three held
// vertices in what is left.
std::vector<Index> hinged_tets(Model& model, const MeshEdit& edit);

}  // namespace lobe
