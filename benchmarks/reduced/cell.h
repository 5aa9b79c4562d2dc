// What one cell of the lattice resists with. With c_k the amplitudes of the four functions that are not
// affine (lattice.h), G_kT = Σ_p φ_k(X_p) ∇λ_p their gradients in tetrahedron T, and their mean Ḡ_k,
//   F_T = F_c + Σ_k c_k ⊗ (G_kT − Ḡ_k),   F_c = I + (2/h) Σ_d c_d ⊗ e_d + Σ_k c_k ⊗ Ḡ_k.
// Green's strain of T is that of F_c and, to first order in c_k, sym Σ_k (F_cᵀ c_k) ⊗ (G_kT − Ḡ_k): the
// energy of all tetrahedra of the cell is
//   W = V W_SVK(F_c) + ½ Σ_kl h_kᵀ K_kl h_l,   h_k = F_cᵀ c_k,
// with a constant K (12 × 12) that is the stiffness at rest of the tetrahedra themselves. A rotation of the
// cell leaves W as it is, exactly.
#pragma once

#include "benchmarks/reduced/lattice.h"

namespace lobe::reduced {

enum class Stiffening {
  none,         // K = 0
  fluctuation,  // K_kl = α Σ_T V_T (G_kT − Ḡ_k)·(G_lT − Ḡ_l) I, with α = 2 μ: set by hand
  galerkin,     // that of the tetrahedra, which follow the eight functions: too stiff when the body bends
  relaxed,      // the same, but they may beside move by ξ², η², ζ² in each direction, and do so at rest
  homogenised   // the same, but they move within the cell as they would at rest, with the moments kept
};

struct Cell {
  double volume = 0;                 // V [m³]
  Eigen::Matrix<double, 3, 4> mean;  // Ḡ_k [1/m]
  Eigen::Matrix<double, 12, 12> K;   // [N/m]
};

// Of those of the cell's tetrahedra that are listed. A cell of few tetrahedra leaves nodes without any
// stiffness: `hold` times that of the four functions in the empty part of the cube is added.
Cell make_cell(const Elements& elements, const Lattice& lattice, Index cell, const std::vector<Index>& tets,
               Stiffening stiffening, double hold = 0.02);

}  // namespace lobe::reduced
