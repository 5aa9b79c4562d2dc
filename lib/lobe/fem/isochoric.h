// What laws have in common whose energy is one of the change of shape and one of volume: with J = det F and
// I₁ = tr FᵀF, φ = J^(−2/3), so that φ I₁ stays 3 when only the volume changes, and K/2 (J − 1)² with
// K = λ + ⅔ μ.
//
// Below J = 1/5 φ is its Taylor polynomial of degree 2 about that point. So energies are finite, with
// continuous second derivatives, for every F, inverted ones too.
#pragma once

#include <algorithm>
#include <cmath>

#include "lobe/fem/solid.h"
#include "lobe/numerics/simd.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
inline constexpr bool is_single_precision = sizeof(T) == 4;
template <class T>
requires requires { typename T::value_type; }
inline constexpr bool is_single_precision<T> = sizeof(typename T::value_type) == 4;

// J^(−1/3) for J from 1/5 to 1,000: a step of Halley's iteration from J^(−1/4), then steps of order 4, which
// do not divide: of e = 1 − J y³, (1 − e)^(−1/3) = 1 + e/3 + 2e²/9 + 14e³/81 … It has the same bits for every
// width of registers.
template <class T>
LOBE_INLINE inline T inverse_cube_root(const T& J) {
  using std::sqrt;
  constexpr int steps = is_single_precision<T> ? 2 : 3;
  const T s = sqrt(T(sqrt(J)));  // inverse of the first guess y; J y³ = s
  T y = (s + T(2)) / (s * (s + s + T(1)));
  unrolled<steps>([&](int) LOBE_INLINE {
    const T e = T(1) - J * y * y * y;
    y = y + y * (e * (T(1.0 / 3) + e * (T(2.0 / 9) + e * T(14.0 / 81))));
  });
  return y;
}

template <class T>
struct IsochoricState {
  Mat3<T> beyond;           // cof F − I
  T v, trace;               // J − 1, I₁ − 3
  T phi, slope, curvature;  // φ, φ′, φ″
  T K;                      // [Pa]

  LOBE_INLINE IsochoricState(const Mat3<T>& H, const Law<T>& law)
      : beyond(cofactor(H) - H.transpose()), v(volume_change(H)) {
    using std::max;
    const T linear = H(0, 0) + H(1, 1) + H(2, 2);
    for (int i = 0; i < 3; ++i) beyond(i, i) += linear;
    trace = linear + linear + H.cwiseProduct(H).sum();
    const T v_least = T(0.2f) - T(1);
    v_root = max(v, v_least);
    const T root = T(1) + v_root;
    below = v - v_root;
    const T y = inverse_cube_root(root);
    phi_root = y * y;
    third = T(1) / (T(3) * root);
    slope_root = -(phi_root + phi_root) * third;
    curvature = T(-5) * slope_root * third;
    slope = slope_root + curvature * below;
    phi = phi_root + below * (slope_root + T(0.5f) * curvature * below);
    K = law.lambda + law.mu * T(2.0 / 3);
  }
  // 2φ + φ′ (trace + 3), free of cancellation.
  LOBE_INLINE T isotropic(const T& of_trace) const {
    return (phi_root + phi_root) * (T(3) * v_root - of_trace) * third +
           below * (slope_root + slope_root + curvature * below + curvature * (of_trace + T(3)));
  }
  LOBE_INLINE T slope_of_trace() const { return slope * (trace + T(3)); }  // φ′ I₁

 private:
  T v_root, below, phi_root, third, slope_root;
};

}  // namespace lobe
