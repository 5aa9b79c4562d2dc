// An optional back end of the static and implicit solvers, faster on large meshes. GPL-2+: see LICENSE here.
#pragma once

#include "lobe/numerics/sparse_factor.h"

namespace lobe {

// CHOLMOD's supernodal L Lᵀ with METIS nested dissection, for positive definite matrices only: where nodal
// pressures make the matrix indefinite, the solvers use make_ldlt() instead.
std::unique_ptr<SparseFactor> make_cholmod();

}  // namespace lobe
