// The stress defect of a linear law: how far its stress is from that of the non-linear model (theory, section
// 15),
//   D = P(F) − σ_linear(∇u)                                                                           [Pa].
// It is computed in a state of the non-linear body. In a state of the linear body, nonlinear_gradient() first
// gives the non-linear state that the linear one stands for.
#pragma once

#include "lobe/fem/mean_material.h"
#include "lobe/linearity/zones.h"

namespace lobe {

// Returns ∇u of the non-linear state that a linear one with gradient H stands for: R U − I. The skew part of
// H is the rotation vector of R. The symmetric part ε of H is the Green strain of the stretch U = √(I + 2ε);
// no stretch is taken below 0.2. So a rotation of the linear state counts as rotation, not as strain.
Mat3<double> nonlinear_gradient(const Mat3<double>& H);

// The defect of the linear law of a material, at the displacement gradient H of the non-linear model.
Mat3<double> stress_defect(const Law<double>& law, const Law<double>& linear, const Mat3<double>& H);  // [Pa]

// ∫ D dV per zone, each with its nine entries in a column [Pa m³]: 9 × #zones.
using Defects = Eigen::Matrix<double, 9, Eigen::Dynamic>;

// Defects of all zones, tetrahedron by tetrahedron, in a state of the non-linear body: u is 3 × #vertices
// [m]. A tetrahedron has a sixth of its volume in each of its smoothing domains.
Defects exact_defects(const Elements& elements, const Zones& zones, const Mat3X<double>& u);

// Defects from the mean displacement gradients of zones alone, 9 × #zones; this costs next to nothing. A zone
// has the mean material, the fibre direction and the law of most of its tetrahedra. Its nodal pressures are
// those of a uniform gradient.
class MeanDefects {
 public:
  MeanDefects(const Elements& elements, const Zones& zones);
  void find(const Elements& elements, const Zones& zones, Index zone);  // call it again after a cut

  Eigen::Matrix<double, 9, 1> gradient(Index zone, const Mat3X<double>& u) const;
  // The defect of a zone with this mean gradient. A linear zone is first given its non-linear state
  // (nonlinear_gradient()).
  Eigen::Matrix<double, 9, 1> at(Index zone, const Eigen::Matrix<double, 9, 1>& gradient,
                                 bool is_linear) const;
  // The defect of a zone whose linear law is the tangent at the mean gradient `about`. For a linear zone,
  // nonlinear_gradient() is applied to its deformation since then.
  Eigen::Matrix<double, 9, 1> beyond_tangent(Index zone, const Eigen::Matrix<double, 9, 1>& gradient,
                                             const Eigen::Matrix<double, 9, 1>& about, bool is_linear) const;

 private:
  struct Weight {
    Index vertex;
    Vec3d gradient;  // gradient of its shape function, averaged over the zone [1/m]
  };
  std::vector<std::vector<Weight>> weights_;  // weights of each zone
  Law<double> law(const MeanMaterial& mean, const Mat3<double>& H) const;

  std::vector<MeanMaterial> mean_;
  double volume_penalty_, guard_below_;
};

}  // namespace lobe
