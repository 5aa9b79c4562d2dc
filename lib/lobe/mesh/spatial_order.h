// The order in which a Hilbert curve passes points. Points that are close in this order are close in space.
// So arrays in this order are read from the caches, whatever the numbering of the mesh.
#pragma once

#include <vector>

#include "lobe/types.h"

namespace lobe {

// Returns the numbers of the points along a Hilbert curve through their bounding cube, which has 2^21 cells
// along each side. Points of one cell keep their order. O(n log n).
std::vector<Index> spatial_order(const Mat3X<double>& points);  // 3 × n [m]

}  // namespace lobe
