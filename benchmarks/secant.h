// What a tool's last motion and the change of its force say of its stiffness: way (a) of `lobe bench haptic`.
#pragma once

#include "lobe/types.h"

namespace lobe::bench {

// The least change of a symmetric K after which K d = −Δf (Powell's symmetric Broyden update), by a share
// that falls to 0 where the tool has hardly moved: below `noise` [m] it is not the motion that changes the
// force.
inline Mat3<double> secant_correction(const Mat3<double>& K, const Vec3d& way, const Vec3d& force_change,
                                      double noise) {
  const double square = way.squaredNorm();
  if (square == 0) return Mat3<double>::Zero();
  const Vec3d rest = -force_change - K * way;
  const Mat3<double> whole = (rest * way.transpose() + way * rest.transpose()) / square -
                             rest.dot(way) / (square * square) * way * way.transpose();
  return square / (square + noise * noise) * whole;
}

}  // namespace lobe::bench
