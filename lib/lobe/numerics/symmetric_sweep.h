// Elimination in dense symmetric matrices that are positive definite, all of it products (dense_products.h).
#pragma once

#include "lobe/numerics/dense_products.h"

namespace lobe {

// The sweep operator (theory, (14.7)) on the first components 1, the others being 2:
//   K_11 ← −K_11⁻¹,  K_21 ← K_21 K_11⁻¹,  K_22 ← K_22 − K_21 K_11⁻¹ K_12.
// Below the diagonal only. False, and K is of no use, where a pivot is not above `loose` of the diagonal's
// entry.
bool sweep(DenseProducts::Matrix& K, Eigen::Index count, double loose, DenseProducts& products);

// K⁻¹ in place of K, both whole.
bool invert(DenseProducts::Matrix& K, double loose, DenseProducts& products);

}  // namespace lobe
