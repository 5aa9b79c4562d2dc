// Condensation that is kept exact while the structure changes (theory, section 14).
//
// A factor gives A = K̂⁻¹ of the structure as it was at first. Since then forces φ on a few touched
// components T stand for all that has changed, so that a field in equilibrium is
//   u = A (f·a + E_T φ),   φ = Φ [a; u_B],                                                          (1)
// with loads f and their amplitudes a, and the displacements u_B of the interface B ⊂ T. Its energy, less
// what the loads have done, is ½ [a; u_B]·S [a; u_B], so that the rows of B in
//   −S [a; u_B]                                                                                     (2)
// are the force on the interface, those of a the work of unit loads on the interior. With the interface held,
// the response to a force is A − A E_T N E_Tᵀ A. Three operations keep Φ, S and N exact, with G =
// dependence of displacements on [a; u_B], R = E_Pᵀ (A − A E N Eᵀ A) E_P, Z = E_P − N A_TP:
//   change:  K and f between components P by ΔK and Δf, wherever they are.
//            W = ΔK − ΔK (R⁻¹ + ΔK)⁻¹ ΔK,  S ← S + Gᵀ W G,  Φ ← Φ − Z W G,  N ← N + Z W Zᵀ             (3)
//            after the change by Δf: S ← S − Gᵀ Δf − Δfᵀ G − Δfᵀ R Δf, Φ ← Φ + Z Δf, in the rows and columns
//            of a
//   promote: P joins B.   C = R⁻¹,
//            S ← [S + Gᵀ C G, −Gᵀ C; −C G, C],  Φ ← [Φ − Z C G, Z C],  N ← N + Z C Zᵀ              (4)
//   demote:  components D of B join the interior.  C = S_DD⁻¹,
//            S ← S − S_:D C S_D:,  Φ ← Φ − Φ_D C S_D:,  N ← N − Φ_D C Φ_Dᵀ                          (5)
// Each costs O((|T| + |B|)² × components). A component that is touched for the first time also costs a column
// of A. An operation loses digits if what is left is much softer than what was removed. With all ΔK and Δf so
// far, (1) should leave no force on the interior. It leaves
//   r = φ + ΔK u − Δf a;                                                                            (6)
// The displacements that r causes, with B held, are the error of (1).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "lobe/numerics/dense_products.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/types.h"

namespace lobe {

class Condensation {
 public:
  using Matrix = Eigen::MatrixXd;
  using Dofs = std::vector<Index>;  // components by their rows of K̂; added ones follow

  // At first nothing is touched and B is empty.
  Condensation(std::unique_ptr<SparseFactor> factor, const Matrix& loads);  // f: size of K̂ × #amplitudes [N]

  // Rows and columns of S: amplitudes, then the interface in this order.
  const Dofs& interface() const { return interface_; }
  const Matrix& stiffness() const { return S_; }  // [N m], [N], [N/m]
  Index column(Index dof) const {
    return column_[std::size_t(dof)];
  }  // number of the dof after the amplitudes; −1 if it is interior
  Index size() const { return static_cast<Index>(slot_.size()); }  // dofs in all
  Index touched() const { return static_cast<Index>(touched_.size()); }

  // Returns false, and changes nothing, if some of the interior could then move without a force.
  bool change(const Dofs& dofs, const Matrix& stiffness,  // #dofs × #dofs [N/m]
              const Matrix& loads);                       // #dofs × #amplitudes [N]
  void promote(const Dofs& dofs);
  // Returns false, and changes nothing, if they could then move without a force.
  bool demote(const Dofs& dofs);
  // Removes components to which nothing is attached any more.
  void forget(const Dofs& dofs);
  // Adds components without stiffness to the interface, which K̂ does not have. They are numbered
  // consecutively; returns the first number. `scale` [N/m] is of the order of K's diagonal.
  Index add(Index count, double scale);

  // The relative error in the energy norm, of the field under the loads or of one under a motion of the
  // interface, whichever is larger. O(|T|²).
  double error() const;

  // Returns the displacements of all dofs in equilibrium, one column for each column [a; u_B].
  Matrix field(const Matrix& driven) const;
  // While the interface is held, forces act on the interior: all dofs × #columns [N]. These return the forces
  // that reach the interface, interface × #columns [N] (field() transposed), and the displacements, all dofs
  // × #columns [m].
  Matrix interface_forces(const Matrix& forces) const;
  Matrix fixed_interface_response(const Matrix& forces) const;

 private:
  Matrix solve(const Matrix& forces, const Matrix& phi) const;
  Matrix of_added(const Matrix& forces) const;
  double error_of(const Eigen::VectorXd& driven) const;
  void touch(const Dofs& dofs);
  void grow_to(Eigen::Index touched);
  void note(const Dofs& dofs, const Matrix& stiffness, const Matrix& loads);
  std::vector<Index> slots(const Dofs& dofs) const;
  std::vector<Index> interior_rows(const Dofs& dofs) const;    // rows of a matrix with one row per dof
  bool known(Index dof) const { return dof < loads_.rows(); }  // whether K̂ has it
  void join(const Dofs& dofs);
  void leave(const Dofs& dofs);
  // G, Z and R of some components. Those on the interface move with the interface alone.
  struct Response {
    Matrix G, Z, R;
  };
  Response response_at(const Dofs& dofs);

  DenseProducts products_;
  std::unique_ptr<SparseFactor> factor_;
  Matrix loads_;                                 // f
  Matrix response_;                              // A f
  Dofs touched_;                                 // T
  Dofs interface_;                               // B
  std::vector<Index> slot_, column_;             // place of each dof in T and in B
  std::vector<double> added_;                    // scale of the dofs that were added
  Matrix A_, N_;                                 // T × T
  Matrix Phi_;                                   // T × [a; B]
  Matrix S_;                                     // [a; B] × [a; B]
  std::vector<Eigen::Triplet<double>> changed_;  // ΔK, T × T: sums of these
  Matrix changed_loads_;                         // Δf, T × #amplitudes
};

}  // namespace lobe
