// A factor of a large sparse stiffness whose work is products of dense blocks: that of a condensed region.
#pragma once

#include "lobe/numerics/sparse_factor.h"

namespace lobe {

// A = L D Lᵀ by blocks, one for each supernode: L is the identity in its diagonal blocks, and D their pivots.
// Found front by front (J. W. H. Liu, The multifrontal method for sparse matrix solution, 1992), a front
// being swept (symmetric_sweep.h). For matrices that are positive definite. The same bits on every processor.
std::unique_ptr<SparseFactor> make_supernodal();

}  // namespace lobe
