// The exact energy, forces and tangent ∂²W/∂u² of a body at a state, for Newton's method.
#pragma once

#include "lobe/region/elements.h"
#include "lobe/solve/sparse_factor.h"
#include "lobe/solve/unknowns.h"

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

// The tangent assembled on the unknowns: the pattern once, its values at every state.
class Tangent {
 public:
  Tangent(const Elements& elements, const Unknowns& unknowns);

  void update(const Mat3X<double>& u);  // 3 × #vertices [m]
  SparseFactor::Matrix& matrix() { return matrix_; }
  const SparseFactor::Matrix& matrix() const { return matrix_; }
  Eigen::Index diagonal(Eigen::Index column) const {
    return matrix_.outerIndexPtr()[column];
  }  // place in its values

  // ∂²W/∂u² w for a displacement w of given components, on the unknowns.
  Eigen::VectorXd times(const Mat3X<double>& u, const Mat3X<double>& w) const;

 private:
  const Elements& elements_;
  const Unknowns& unknowns_;
  SparseFactor::Matrix matrix_;
  std::vector<Index>
      place_;  // per alive tetrahedron and entry of its lower triangle: where in the values, or −1
};

}  // namespace lobe
