#include "lobe/condense/rigid_frame.h"

#include <Eigen/Geometry>
#include <cmath>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

Vec3d mean(const Mat3X<double>& x, const Eigen::VectorXd& weights) {
  Vec3d sum = Vec3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) sum += weights[i] * x.col(i);
  return sum / weights.sum();
}

// The rotation for which the trace of RᵀM is largest: the eigenvector of the largest eigenvalue of Horn's
// matrix.
Mat3<double> closest_rotation(const Mat3<double>& M) {
  const Vec3d axial(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
  Eigen::Matrix4d N;
  N(0, 0) = M.trace();
  N.topRightCorner<1, 3>() = axial.transpose();
  N.bottomLeftCorner<3, 1>() = axial;
  N.bottomRightCorner<3, 3>() = M + M.transpose() - M.trace() * Mat3<double>::Identity();
  const Eigen::Vector4d q = symmetric_eigen(N).vectors.col(3);
  if (axial.isZero(0) && std::abs(q[0]) > 0.5)
    return Mat3<double>::Identity();  // a body at rest stays exactly at rest
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace

RigidFrame::RigidFrame(const Mat3X<double>& rest, Eigen::VectorXd weights)
    : w_(std::move(weights)), C_(mean(rest, w_)) {
  Y_ = rest.colwise() - C_;
}

void RigidFrame::fit(Pose& pose) const {
  pose.centroid = mean(pose.d, w_);
  Mat3<double> M = Mat3<double>::Zero(), at_rest = M;
  for (Eigen::Index i = 0; i < Y_.cols(); ++i) {
    pose.d.col(i) -= pose.centroid;
    const Mat3<double> of_point =
        pose.d.col(i) * Y_.col(i).transpose();  // then weighted: symmetric to the bit at rest
    M += w_[i] * of_point;
    at_rest += w_[i] * Y_.col(i) * Y_.col(i).transpose();
  }
  pose.R = closest_rotation(M);
  for (Eigen::Index i = 0; i < Y_.cols(); ++i)
    pose.d.col(i) = pose.R.transpose() * Vec3d(pose.d.col(i)) - Y_.col(i);
  const Mat3<double> stretch = pose.R.transpose() * M;
  const Mat3<double> A = stretch.trace() * Mat3<double>::Identity() - (stretch + stretch.transpose()) / 2;
  constexpr double least = 1e-9;  // of the size of A at rest, about which the inverse is still good
  const double size = at_rest.trace();
  bool is_unique = false;
  A.computeInverseWithCheck(pose.A_inverse, is_unique, least * size * size * size);
  if (!is_unique) pose.A_inverse.setZero();
}

RigidFrame::Rate RigidFrame::rate(const Pose& pose, const Mat3X<double>& v) const {
  Rate rate{Vec3d::Zero(), Vec3d::Zero(), pose.R.transpose() * v};
  rate.velocity = mean(rate.d, w_);
  rate.d.colwise() -= rate.velocity;
  for (Eigen::Index i = 0; i < Y_.cols(); ++i) rate.spin += w_[i] * Y_.col(i).cross(rate.d.col(i));
  rate.spin = pose.A_inverse * rate.spin;
  for (Eigen::Index i = 0; i < Y_.cols(); ++i)
    rate.d.col(i) -= rate.spin.cross(Vec3d(Y_.col(i) + pose.d.col(i)));
  return rate;
}

Vec3d RigidFrame::torque(const Pose& pose, const Mat3X<double>& f) const {
  Vec3d torque = Vec3d::Zero();
  for (Eigen::Index i = 0; i < Y_.cols(); ++i) torque += (Y_.col(i) + pose.d.col(i)).cross(f.col(i));
  return torque;
}

void RigidFrame::take_off(const Pose& pose, const Vec3d& torque, Mat3X<double>& f) const {
  const Vec3d turn = pose.A_inverse * torque;
  for (Eigen::Index i = 0; i < Y_.cols(); ++i) f.col(i) -= w_[i] * turn.cross(Vec3d(Y_.col(i)));
}

}  // namespace lobe
