// Signed distances to rigid shapes, for numbers and for packs of them (numerics/simd.h) alike.
#pragma once

#include <cmath>

#include "lobe/numerics/lane_mask.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
struct DistanceOf {
  T value;           // φ [m]
  Vec3<T> gradient;  // ∇φ
};

// In an order that does not depend on how Eigen sums.
template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

template <class T>
DistanceOf<T> sphere_distance(double radius, const Vec3<T>& x) {
  using std::sqrt;
  const T r = sqrt(dot(x, x)), inverse = T(1) / r;
  const auto is_off = is_less(T(0), r);
  return {r - T(radius),
          {pick(is_off, T(x[0] * inverse), T(0)), pick(is_off, T(x[1] * inverse), T(0)),
           pick(is_off, T(x[2] * inverse), T(1))}};
}

// About the segment from the origin to `length` along z.
template <class T>
DistanceOf<T> capsule_distance(double radius, double length, const Vec3<T>& x) {
  const T z = pick(is_less(x[2], T(0)), T(0), pick(is_less(T(length), x[2]), T(length), x[2]));
  return sphere_distance<T>(radius, {x[0], x[1], x[2] - z});
}

template <class T>
DistanceOf<T> plane_distance(const Vec3<T>& x) {
  return {x[2], {T(0), T(0), T(1)}};
}

// Outside the nearest point of the box, inside the nearest of its six faces.
template <class T>
DistanceOf<T> box_distance(const Vec3d& half_size, const Vec3<T>& x) {
  using std::sqrt;
  Vec3<T> sign, beyond, out;
  for (int i = 0; i < 3; ++i) {
    sign[i] = pick(is_less(x[i], T(0)), T(-1), T(1));
    beyond[i] = x[i] * sign[i] - T(half_size[i]);
    out[i] = pick(is_less(beyond[i], T(0)), T(0), beyond[i]);
  }
  const T far = sqrt(dot(out, out));
  const auto is_outside = is_less(T(0), far);
  const auto is_y = is_less(beyond[0], beyond[1]);
  const T xy = pick(is_y, beyond[1], beyond[0]);
  const auto is_z = is_less(xy, beyond[2]);
  const T faces[3] = {pick(is_z, T(0), pick(is_y, T(0), sign[0])),
                      pick(is_z, T(0), pick(is_y, sign[1], T(0))), pick(is_z, sign[2], T(0))};
  DistanceOf<T> found{pick(is_outside, far, pick(is_z, beyond[2], xy)), {}};
  for (int i = 0; i < 3; ++i) found.gradient[i] = pick(is_outside, T(out[i] * sign[i] / far), faces[i]);
  return found;
}

// To the nearer of two boxes of this size (setup/rigid_shape.h). The one is the mirror image of the other in
// y = 0.
template <class T>
DistanceOf<T> jaws_distance(const Vec3d& size, double opening, const Vec3<T>& x) {
  const T side = pick(is_less(x[1], T(0)), T(-1), T(1));
  DistanceOf<T> found =
      box_distance<T>({size[0] / 2, size[1] / 2, size[2] / 2},
                      {x[0], side * x[1] - T((opening + size[1]) / 2), x[2] - T(size[2] / 2)});
  found.gradient[1] *= side;
  return found;
}

}  // namespace lobe
