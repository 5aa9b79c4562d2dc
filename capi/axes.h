// Converts between the axes of an engine and those of lobe: x' = s Q x + t, with Q orthogonal. Q may mirror.
#pragma once

#include <Eigen/Geometry>

#include "lobe/types.h"

namespace lobe::c {

class Axes {
 public:
  Axes() = default;
  explicit Axes(const double* rows);  // 3 × 4, row by row; throws InputError

  bool is_mirrored() const { return turn_.determinant() < 0; }
  Vec3d point_out(const Vec3d& x) const { return scale_ * (turn_ * x) + shift_; }
  Vec3d point_in(const Vec3d& x) const { return turn_.transpose() * (x - shift_) / scale_; }
  Vec3d direction_out(const Vec3d& d) const { return turn_ * d; }  // also of forces [N]
  Vec3d direction_in(const Vec3d& d) const { return turn_.transpose() * d; }
  // Torques change their sign if the axes are mirrored.
  Vec3d torque_out(const Vec3d& m) const { return turn_.determinant() * (turn_ * m); }
  double length_in(double length) const { return length / scale_; }
  // A rotation R becomes Q R Qᵀ: its axis is turned as a torque is.
  Eigen::Vector4d rotation_out(const Eigen::Vector4d& q) const { return turned(q, turn_); }
  Eigen::Vector4d rotation_in(const Eigen::Vector4d& q) const { return turned(q, turn_.transpose()); }

 private:
  static Eigen::Vector4d turned(const Eigen::Vector4d& q, const Mat3<double>& Q) {
    const Vec3d axis = Q.determinant() * (Q * q.head<3>());
    return {axis.x(), axis.y(), axis.z(), q.w()};
  }

  Mat3<double> turn_ = Mat3<double>::Identity();
  double scale_ = 1;
  Vec3d shift_ = Vec3d::Zero();
};

}  // namespace lobe::c
