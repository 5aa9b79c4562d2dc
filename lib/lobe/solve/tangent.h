// The exact energy, forces and tangent ∂²W/∂u² of a body at a state, for Newton's method.
#pragma once

#include <array>
#include <span>

#include "lobe/numerics/sparse_factor.h"
#include "lobe/region/averages.h"
#include "lobe/solve/unknowns.h"

namespace lobe {

// Energy [J] and internal forces −∂W/∂u (3 × #vertices [N]) of the alive tetrahedra, each by the model of its
// region.
struct EnergyAndForces {
  double energy = 0;
  Mat3X<double> forces;
  double smallest_volume_ratio = 1;  // smallest det F over the non-linear tetrahedra
  Index smallest_tet = -1;
};
EnergyAndForces energy_and_forces(const Elements& elements, const Averages& averages,
                                  const Mat3X<double>& u);  // 3 × #vertices [m]
inline EnergyAndForces energy_and_forces(const Elements& elements, const Mat3X<double>& u) {
  return energy_and_forces(elements, Averages(elements), u);
}

// ∂²W/∂u_j∂u_k of one tetrahedron as if it were plain, at given nodal pressures, a 12 × 12 matrix of 3 × 3
// blocks [N/m]: V linear_block() of a linear one, else V times law_stiffness() (fem/law.h).
using TetStiffness = Eigen::Matrix<double, 12, 12>;
TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u, RegionModel model,
                           double pressure = 0);  // mean of its nodes' pressures [Pa]
inline TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u) {
  return tet_stiffness(elements, tet, u, elements.region_of[tet]);
}

// The stiffness of what a tetrahedron has by itself: all, or, if it is smoothed, volume term and guard.
TetStiffness unsmoothed_stiffness(const Elements& elements, Index tet, const Mat34<double>& u,
                                  RegionModel model, double pressure = 0);
// ∂P/∂F of a smoothing domain [Pa]: component i of column d of either is number 3d + i.
using Moduli = Eigen::Matrix<double, 9, 9>;
Moduli domain_moduli(const Elements& elements, const SmoothedEdge& edge,
                     const Mat3<double>& H,                    // its ∇u
                     RegionModel model, double pressure = 0);  // mean pressure of both ends [Pa]
// The stiffness of the vertices of a smoothing domain: V_e b_j·C b_k with C = ∂P/∂F.
Eigen::MatrixXd domain_stiffness(const Elements& elements, const SmoothedEdge& edge,
                                 const Mat3<double>& H,                    // ∇u of the domain
                                 RegionModel model, double pressure = 0);  // mean pressure of both ends [Pa]

// The tangent assembled on the unknowns. The pattern is found once, the values at every state. Nodal
// pressures (PressureNodes) couple all tetrahedra around a vertex. They are unknowns, too, so that the matrix
// stays sparse:
//   [ K   Gᵀ ] [du]   [r]
//   [ G  −D ] [dp] = [0],   G_n = ∂(V_n θ_n)/∂u,  D = diag(V_n / χλ).
// That is the system of the tangent K + Gᵀ D⁻¹ G of the energy. Where this is positive definite, the matrix
// has one negative eigenvalue per pressure.
class Tangent {
 public:
  Tangent(const Elements& elements, const Unknowns& unknowns);

  const Averages& averages() const { return averages_; }
  const SparseFactor::Matrix& matrix() const { return matrix_; }  // its lower triangle

  void update(const Mat3X<double>& u);        // 3 × #vertices [m]
  void add_diagonal(const Mat3X<double>& k);  // adds springs, 3 × #vertices [N/m]
  // Makes it scale × the tangent + weight × the lumped masses [kg], per vertex.
  void scale_and_add_mass(double scale, double weight, const std::vector<double>& mass);

  // Returns a factor that is analysed for the pattern. It is the default one if the matrix is indefinite and
  // the wanted one takes definite matrices only.
  std::unique_ptr<SparseFactor> make_factor(const SparseFactorMaker& wanted) const;
  // Adds growing multiples of its diagonal to a tangent that is not positive definite until it is, and sets
  // `damped`.
  bool factorise(SparseFactor& factor, bool& damped);
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const;  // at the unknowns
  // Solves for the forces minus those of a displacement w of given components: 3 × #vertices [m].
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces, const Mat3X<double>& u,
                        const Mat3X<double>& w) const;

 private:
  using TetEntries = std::array<double, 78 + 48>;  // lower triangle, then G of its four nodes
  int entry_count() const { return averages_.nodes.any() ? 78 + 48 : 78; }
  TetEntries entries_of(Index tet, const Mat34<double>& u, double pressure) const;
  template <class Visit>  // visit(row, column) of each entry; row −1 where it is not in the matrix
  void for_places(Index tet, Visit&& visit) const;
  template <class Visit>  // visit(row, column): lower triangle of these vertices' stiffness, column by column
  void for_places(std::span<const Index> vertices, Visit&& visit) const;
  template <class Visit>  // visit(number of a domain)
  void for_domains(Visit&& visit) const;
  template <class Visit>
  void for_domain_places(Index edge, Visit&& visit) const;
  // V_e/2 F_e b_j of a domain's vertices, one after the other: its part of G of both ends [m²].
  Eigen::VectorXd slope_of(Index edge, const Mat3<double>& H) const;
  void find_places();

  const Elements& elements_;
  const Unknowns& unknowns_;
  Averages averages_;
  std::vector<Index> row_of_node_, row_of_edge_node_;  // row of each node; −1 where it is not in use
  Index pressures_ = 0;
  SparseFactor::Matrix matrix_;
  // Where each entry of the alive tetrahedra, then of the domains, is in the values, or −1.
  std::vector<Index> place_;
};

}  // namespace lobe
