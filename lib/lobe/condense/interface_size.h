// Estimates whether a condensed region is cheaper: per step the interface costs a dense product, and the
// tetrahedra would cost a sparse one.
#pragma once

#include "lobe/fem/elements.h"

namespace lobe {

struct InterfaceSize {
  Index vertices = 0;  // vertices of tetrahedra of this model and of others
  Index tets = 0;      // tetrahedra of this model
};
InterfaceSize interface_size(const Elements& elements, RegionModel model = RegionModel::precomputed);

// Throws InputError for an interface of so many components whose dense matrices would not fit into memory.
void refuse_interface(Index components);

}  // namespace lobe
