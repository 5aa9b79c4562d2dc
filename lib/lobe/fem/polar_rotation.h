// The rotation R of F = R S, S symmetric with eigenvalues s₁ ≥ s₂ ≥ |s₃|. It is the rotation nearest to F,
// and that for which R:F is largest. det R = 1 also where det F < 0.
//
// R:F = tr S = s₁ + s₂ + s₃ is the largest root t of
//   p(t) = t⁴ − 2 |F|² t² − 8 det F t + |F|⁴ − 4 |cof F|²
// (the others are s₁ − s₂ − s₃, s₂ − s₁ − s₃ and s₃ − s₁ − s₂), and R = ∂t/∂F:
//   R = ((t² + |F|²) F + 2 t cof F − 2 F FᵀF) / D,  D = t³ − |F|² t − 2 det F = 2 (s₁+s₂)(s₂+s₃)(s₁+s₃)
// (H. Lin, F. M. Chitalu, T. Komura, Isotropic ARAP energy using Cauchy-Green invariants, ACM Trans. Graph.
// 41, 2022, have t in closed form). With F scaled to |F|² = 3, Newton's method starts from the tangent to p
// at rest, t = 3. The formula does not divide by det F, so R is as exact for a flat tetrahedron as at rest.
//
// As s₂ + s₃ → 0 it loses digits: two rotations are as near to F there. R is then that of the unit quaternion
// that makes qᵀBq largest (B. K. P. Horn, Closed-form solution of absolute orientation using unit
// quaternions, J. Opt. Soc. Am. A 4, 1987), found by squarings of B. That is a rotation for every F; it is I
// for F = 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/fem/volume_term.h"
#include "lobe/numerics/lane_mask.h"

namespace lobe {

// Inline always: a copy of a function in an object of kernels could be run by a processor without their
// instructions.

inline bool any_of(bool lane) { return lane; }  // as for packs of numbers

// The type of one number: of T itself, or of a lane of a pack T.
template <class T>
struct LaneNumber {
  using type = T;
};
template <class T>
requires requires { typename T::value_type; }
struct LaneNumber<T> {
  using type = typename T::value_type;
};

// R of a unit quaternion, times |q|².
template <class T>
[[gnu::always_inline]] inline Mat3<T> quaternion_rotation(const T& w, const T& x, const T& y, const T& z) {
  const T two(2), xx = x * x, yy = y * y, zz = z * z, ww = w * w;
  Mat3<T> R;
  R << ww + xx - yy - zz, two * (x * y - w * z), two * (x * z + w * y),  //
      two * (x * y + w * z), ww - xx + yy - zz, two * (y * z - w * x),   //
      two * (x * z - w * y), two * (y * z + w * x), ww - xx - yy + zz;
  return R;
}

// By squarings of B + 2I; the eigenvalues of B are the four roots.
template <class T>
[[gnu::always_inline]] inline Mat3<T> rotation_by_quaternion(const Mat3<T>& A) {  // |A|² = 3, or 0
  using Four = Eigen::Matrix<T, 4, 4>;
  const T shift(2), zero(0);  // 2 makes the largest eigenvalue the farthest from 0, for every A
  Four B;
  B(0, 0) = A(0, 0) + A(1, 1) + A(2, 2) + shift;
  B(1, 1) = A(0, 0) - A(1, 1) - A(2, 2) + shift;
  B(2, 2) = A(1, 1) - A(0, 0) - A(2, 2) + shift;
  B(3, 3) = A(2, 2) - A(0, 0) - A(1, 1) + shift;
  B(0, 1) = A(2, 1) - A(1, 2), B(0, 2) = A(0, 2) - A(2, 0), B(0, 3) = A(1, 0) - A(0, 1);
  B(1, 2) = A(0, 1) + A(1, 0), B(1, 3) = A(0, 2) + A(2, 0), B(2, 3) = A(1, 2) + A(2, 1);
  constexpr int squarings = 24;  // tell eigenvalues apart that differ by 1e-6
  for (int n = 0; n < squarings; ++n) {
    Four C;
    T trace = zero;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) B(i, j) = B(j, i);
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) {
        C(i, j) = B(i, 0) * B(0, j) + B(i, 1) * B(1, j) + B(i, 2) * B(2, j) + B(i, 3) * B(3, j);
        if (i == j) trace += C(i, i);
      }
    const T scale = T(1) / trace;
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) B(i, j) = C(i, j) * scale;
  }
  T largest = B(0, 0), q[4] = {B(0, 0), B(0, 1), B(0, 2), B(0, 3)};
  for (int i = 1; i < 4; ++i) {
    const auto is_larger = is_less(largest, B(i, i));
    largest = pick(is_larger, B(i, i), largest);
    for (int j = 0; j < 4; ++j) q[j] = pick(is_larger, i <= j ? B(i, j) : B(j, i), q[j]);
  }
  const T scale = T(1) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return quaternion_rotation(q[0], q[1], q[2], q[3]) * scale;
}

template <class T>
[[gnu::always_inline]] inline Mat3<T> polar_rotation(const Mat3<T>& F) {
  using std::abs, std::max, std::min, std::sqrt;
  using Real = typename LaneNumber<T>::type;
  constexpr bool is_single = sizeof(Real) == 4;
  const T norm = max(T(F.cwiseProduct(F).sum()), T(Real(1e-30)));
  const Mat3<T> A = F * sqrt(T(T(3) / norm)), cof = cofactor(A);
  const T J = A(0, 0) * cof(0, 0) + A(1, 0) * cof(1, 0) + A(2, 0) * cof(2, 0);
  const T minors = cof.cwiseProduct(cof).sum();
  T t = T(Real(39.0 / 16)) + minors * T(Real(1.0 / 16)) + J * T(Real(3.0 / 8)), step(0);
  const auto improve = [&]() __attribute__((always_inline)) {
    const T beyond = t * t - T(3), quarter = T(0.25f) * beyond * beyond - ((J + J) * t + minors);  // p/4
    step = quarter / (t * beyond - (J + J));
    t -= step;
  };
  constexpr int steps = is_single ? 2 : 3;
  for (int i = 0; i < steps; ++i) improve();
  // The error after a step is about its square.
  constexpr Real most = is_single ? Real(1e-4) : Real(4e-9);
  const T D = t * (t * t - T(3)) - (J + J), margin = min(T(D - T(1)), T(T(most) - abs(step)));
  const Mat3<T> AC = A.lazyProduct(A.transpose().lazyProduct(A));
  Mat3<T> R = A * (t * t + T(3)) + cof * (t + t) - (AC + AC);
  R *= T(1) / D;
  // Most of its rounding error is one of its length, √3: this is a Newton step towards it.
  R *= T(1.5f) - R.cwiseProduct(R).sum() * T(Real(1.0 / 6));
  if (any_of(is_less(margin, T(0)))) {
    const Mat3<T> other = rotation_by_quaternion(A);
    for (int i = 0; i < 9; ++i) R.data()[i] = pick(is_less(margin, T(0)), other.data()[i], R.data()[i]);
  }
  return R;
}

}  // namespace lobe
