// Finds the rigid motion that fits displaced points best. A linear region that moves with this frame may turn
// as a whole (theory, (14.8) to (14.10), where R and A are called Q and B). Y_i are the rest positions about
// their centroid, y_i the present positions about theirs, and w_i the weights. The rotation R makes
// Σ w_i y_i·R Y_i as large as it can be (B. K. P. Horn, Closed-form solution of absolute orientation using
// unit quaternions, 1987). Where points move with velocities v_i, R turns with the angular velocity
//   ω = R A⁻¹ Σ w_i Y_i × Rᵀ v_i,  A = Σ w_i [(Y_i·Rᵀ y_i) I − Y_i (Rᵀ y_i)ᵀ].                        (1)
#pragma once

#include "lobe/types.h"

namespace lobe {

class RigidFrame {
 public:
  struct Pose {
    Mat3<double> R = Mat3<double>::Identity();
    Vec3d centroid = Vec3d::Zero();                 // centroid of the points [m]
    Mat3X<double> d;                                // the part that is not rigid: Rᵀ y − Y [m]
    Mat3<double> A_inverse = Mat3<double>::Zero();  // [1/(w m²)]; zero where no single rotation fits best
  };
  struct Rate {
    Vec3d velocity, spin;  // velocity and spin of the frame, along its own axes [m/s], [1/s]
    Mat3X<double> d;       // [m/s]
  };

  RigidFrame() = default;
  RigidFrame(const Mat3X<double>& rest, Eigen::VectorXd weights);  // 3 × #points [m], > 0

  const Mat3X<double>& arms() const { return Y_; }  // [m]
  const Vec3d& centroid() const { return C_; }      // centroid at rest [m]

  void fit(Pose& pose) const;                                 // fits the pose to positions d in space [m]
  Rate rate(const Pose& pose, const Mat3X<double>& v) const;  // v: 3 × #points, in space [m/s]
  // Forces and torques here are in the frame and about the centroid. torque() is that of forces on the points
  // [N m]. take_off() adds the forces −w_i A⁻¹τ × Y_i, whose torque is −τ and whose resultant is 0.
  Vec3d torque(const Pose& pose, const Mat3X<double>& f) const;
  void take_off(const Pose& pose, const Vec3d& torque, Mat3X<double>& f) const;

 private:
  Mat3X<double> Y_;
  Eigen::VectorXd w_;
  Vec3d C_ = Vec3d::Zero();
};

}  // namespace lobe
