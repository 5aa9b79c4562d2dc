// The exact tangent ∂²W/∂u² of a body at a state, for Newton's method.
#pragma once

#include <Eigen/SparseCore>

#include "lobe/region/elements.h"

namespace lobe {

// Energy [J], internal forces −∂W/∂u (3 × #vertices [N]) of the alive tetrahedra, each with the model of its region.
struct EnergyAndForces {
  double energy = 0;
  Mat3X<double> forces;
  double smallest_volume_ratio = 1;  // of det F over the non-linear tetrahedra
  Index smallest_tet = -1;
};
EnergyAndForces energy_and_forces(const Elements& elements, const Mat3X<double>& u);  // 3 × #vertices [m]

// ∂²W/∂u_j∂u_k of one tetrahedron, a 12 × 12 matrix of 3 × 3 blocks [N/m]:
//   linear      V B_jk                                              (hooke_block)
//   SVK         V ((α_j·S α_k) I + F B_jk Fᵀ)
//   volume term V (2κ|v| g_j⊗g_k + κ v|v| ∂g_j/∂x_k),  g_j = cof(F) α_j,  ∂g_j/∂x_k w = w × F(α_j × α_k)
using TetStiffness = Eigen::Matrix<double, 12, 12>;
TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u);

// Assembled on the free vertices: `unknown` gives the first of three rows of each, −1 where held. Lower triangle.
Eigen::SparseMatrix<double> tangent(const Elements& elements, const Mat3X<double>& u,
                                    const std::vector<Index>& unknown, Index unknowns);

}  // namespace lobe
