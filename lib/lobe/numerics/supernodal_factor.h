// The factor of a condensed region: of a large sparse stiffness, computed by products of dense blocks.
#pragma once

#include "lobe/numerics/sparse_factor.h"

namespace lobe {

// A = L D Lᵀ by blocks, one for each supernode: L is the identity in its diagonal blocks, and D their pivots.
// It is computed front by front (J. W. H. Liu, The multifrontal method for sparse matrix solution, 1992), and
// each front is swept (symmetric_sweep.h). The matrix must be positive definite. The bits are the same on
// every processor.
std::unique_ptr<SparseFactor> make_supernodal();

}  // namespace lobe
