// Elimination in dense symmetric matrices that are positive definite, by dense products (dense_products.h).
#pragma once

#include "lobe/numerics/dense_products.h"

namespace lobe {

// The sweep operator (theory, (14.7)) on the first components 1, the others being 2:
//   K_11 ← −K_11⁻¹,  K_21 ← K_21 K_11⁻¹,  K_22 ← K_22 − K_21 K_11⁻¹ K_12.
// It works below the diagonal only. False if a pivot is not above `loose` times its diagonal entry; K is then
// of no use.
bool sweep(DenseProducts::Matrix& K, Eigen::Index count, double loose, DenseProducts& products);

// Replaces K by K⁻¹, of which both triangles are set.
bool invert(DenseProducts::Matrix& K, double loose, DenseProducts& products);

}  // namespace lobe
