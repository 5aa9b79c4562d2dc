// Checks that a pre-computed region is held in place. The region is linear: a part that could turn as a whole
// would grow. So each part must be held by boundary conditions, or be the one part with a corotated frame.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

// Returns the pre-computed tetrahedra of parts that are not held. A part is connected by faces within the
// region. It is not held if no boundary condition holds a vertex of it, or if it could move as a rigid body
// while its interface and its held vertices stand still. In a region with a frame all parts but the largest
// count as not held, and the largest if it could move so. O(#tetrahedra).
std::vector<Index> unsupported_tets(const Elements& elements, const HeldVertices& held);

// Throws InputError that names such a part.
void refuse_unsupported(const Elements& elements, const HeldVertices& held);

}  // namespace lobe
