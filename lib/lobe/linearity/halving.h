// Divides a body into parts of about equal size, where METIS is not to be had.
#pragma once

#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

// The part of each tetrahedron, 0 … count − 1, by recursive coordinate bisection (M. J. Berger, S. H.
// Bokhari, 1987): tetrahedra are halved along the longest side of the box of their centres. Sizes differ by
// at most one. `count` 1 … #tetrahedra. O(#tetrahedra log count).
std::vector<Index> parts_by_halving(const Elements& elements, Index count);

}  // namespace lobe
