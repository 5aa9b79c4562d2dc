// What keeps a pre-computed region in place. It is linear: a part that could turn as a whole would grow, so
// that each must be held by boundary conditions of its own, or be the one part that has a frame that turns
// with it.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

// The pre-computed tetrahedra of parts (that hang together by faces within the region) none of whose vertices
// is held by a boundary condition, or that could move as a rigid body although what they share with other
// regions, and what is held, stands still. Of a region with a frame all but the largest part, and this if it
// could move so. O(#tetrahedra).
std::vector<Index> unanchored_tets(const Elements& elements, const HeldVertices& held);

// Throws InputError that names such a part.
void refuse_unanchored(const Elements& elements, const HeldVertices& held);

}  // namespace lobe
