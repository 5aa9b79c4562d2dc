// What the equations of an equilibrium ask of the elements of a body: their energy, forces and tangent at a
// state, on nodes that may be vertices or more.
#pragma once

#include <memory>

#include "lobe/solve/tangent.h"

namespace lobe {

class Discretisation {
 public:
  virtual ~Discretisation() = default;

  virtual EnergyAndForces energy_and_forces(const Mat3X<double>& u) const = 0;  // 3 × #nodes [m]
  // Finds the tangent at a state, of the elements alone.
  virtual void update(const Mat3X<double>& u) = 0;
  virtual void add_diagonal(const Mat3X<double>& k) = 0;  // adds springs, 3 × #nodes [N/m]
  // The following functions are those of Tangent.
  virtual std::unique_ptr<SparseFactor> make_factor(const SparseFactorMaker& wanted) const = 0;
  virtual bool factorise(SparseFactor& factor, bool& damped) = 0;
  // Factorises the tangent as it is. Returns whether it is positive definite.
  virtual bool is_stable(SparseFactor& factor) = 0;
  virtual Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const = 0;
  virtual Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces,
                                const Mat3X<double>& u, const Mat3X<double>& w) const = 0;
};

}  // namespace lobe
