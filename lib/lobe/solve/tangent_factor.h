// The factor of a tangent matrix, which may be indefinite at a state that is no equilibrium.
#pragma once

#include "lobe/numerics/sparse_factor.h"
#include "lobe/types.h"

namespace lobe {

// A factor of the wanted kind, analysed for the pattern of a matrix. It is the default one if the matrix is
// to have negative eigenvalues and the wanted kind takes definite matrices only.
std::unique_ptr<SparseFactor> make_tangent_factor(const SparseFactorMaker& wanted,
                                                  const SparseFactor::Matrix& matrix, bool is_indefinite);

// Factorises a matrix that is to have so many negative eigenvalues. If it has not, growing multiples of the
// first `unknowns` entries of its diagonal are added until it has, and `damped` is set.
bool factorise_damped(SparseFactor& factor, SparseFactor::Matrix& matrix, Index unknowns, Index negative,
                      bool& damped);

}  // namespace lobe
