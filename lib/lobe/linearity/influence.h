// The influence of a stress in one zone on the mean displacement of every zone, of a body at rest (theory,
// section 15):
//   e_y = M_yz ∫_z D dV,   M_yz = mean over z of the gradient of K⁻¹ (mean over y)ᵀ.
// With the stress defects of linear zones it gives the displacement error that they cause, exact to first
// order.
#pragma once

#include "lobe/linearity/zones.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

class Influence {
 public:
  // Costs one sparse factor and three solves per zone. `grasps` are sets of vertices that may be grasped
  // later, as rigid bodies. Pieces that float without a grasp are left out.
  Influence(const Elements& elements, const Zones& zones, const HeldVertices& held,
            const std::vector<std::vector<Index>>& grasps);

  // Sets which grasps hold from now on: their numbers, sorted. None at first.
  void hold(const std::vector<Index>& grasps);

  // Mean displacements of all zones [m], 3 × #zones in one column, from the defect of one [Pa m³].
  Eigen::VectorXd displacement(Index zone, const Eigen::Matrix<double, 9, 1>& defect) const {
    return (M_.middleCols<9>(9 * zone) * defect.cast<float>()).cast<double>();
  }
  // Mean displacements from the defects of all zones. A zone without a defect costs nothing.
  Eigen::VectorXd displacement(const Eigen::Matrix<double, 9, Eigen::Dynamic>& defects) const {
    Eigen::VectorXf sum = Eigen::VectorXf::Zero(M_.rows());
    for (Eigen::Index z = 0; z < defects.cols(); ++z)
      if (!defects.col(z).isZero(0)) sum.noalias() += M_.middleCols<9>(9 * z) * defects.col(z).cast<float>();
    return sum.cast<double>();
  }

 private:
  // Unit forces along the six rigid motions of a grasp, and their effect.
  struct Grasp {
    Eigen::Matrix<double, Eigen::Dynamic, 6> forces, fields;  // 3 × #vertices [N], [m]
    Eigen::Matrix<double, Eigen::Dynamic, 6> means;           // means of fields, 3 × #zones
    Eigen::Matrix<double, Eigen::Dynamic, 6> gradients;       // mean gradients of fields, 9 × #zones
  };
  std::vector<Grasp> grasps_;
  std::vector<Index> holding_;
  Eigen::MatrixXf free_, M_;  // 3 × #zones by 9 × #zones: without grasps, and as they hold
};

}  // namespace lobe
