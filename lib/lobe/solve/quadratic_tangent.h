// Energy, forces and tangent of a body of 10-node tetrahedra (quadratic_element.h), each by the model of its
// region. All of λ acts at each point of integration: nodal pressure is a remedy of the plain tetrahedron.
#pragma once

#include "lobe/solve/discretisation.h"
#include "lobe/solve/quadratic_element.h"
#include "lobe/solve/quadratic_mesh.h"

namespace lobe {

class QuadraticTangent : public Discretisation {
 public:
  // All must outlive it; the unknowns are of the nodes of the mesh.
  QuadraticTangent(const Elements& elements, const QuadraticMesh& mesh, const Unknowns& unknowns);

  EnergyAndForces energy_and_forces(const Mat3X<double>& u) const override;
  void update(const Mat3X<double>& u) override;
  void add_diagonal(const Mat3X<double>& k) override;
  std::unique_ptr<SparseFactor> make_factor(const SparseFactorMaker& wanted) const override;
  bool factorise(SparseFactor& factor, bool& damped) override;
  bool is_stable(SparseFactor& factor) override { return factor.factorise(matrix_); }
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const override;
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces, const Mat3X<double>& u,
                        const Mat3X<double>& w) const override;

  const SparseFactor::Matrix& matrix() const { return matrix_; }  // lower triangle

 private:
  using NodeColumns = Eigen::Matrix<double, 3, 10>;
  using Stiffness = Eigen::Matrix<double, 30, 30>;

  Law<double> law_of(Index tet) const;
  NodeColumns nodes_of(Index tet, const Mat3X<double>& u) const;
  Stiffness stiffness_of(Index tet, const NodeColumns& u) const;
  void make_pattern();
  Index place_of(Index row, Index column) const;

  const Elements& elements_;
  const QuadraticMesh& mesh_;
  const Unknowns& unknowns_;
  SparseFactor::Matrix matrix_;
};

}  // namespace lobe
