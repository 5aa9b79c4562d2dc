// The pressure of a contact as a function of its depth, and its friction. Tools and a body against itself
// have the same law, for numbers and for packs of them (numerics/simd.h) alike.
//
//   p = κ ⟨d + h⟩ + δ κ ⟨−v_n⟩,  ḣ = ρ d,  0 ≤ h,   where d + h ≤ `deepest`
//   f_t = −k_t ξ,  k_t = κ/2,  |f_t| ≤ μ p
//
// d is the depth, negative outside. h is the depth at which the contact is held: it grows while a contact is
// deep, until the contact bears its load at no depth. κ is as large as the step allows, so that contact is
// softer than tissue beneath it; at rest it is rigid. Where p becomes 0 the contact ends, and h is forgotten.
//
// ρ is a share of the body's damping γ, for the following reason. Free motions z e^{st} of a linear body of
// mass M and stiffness K that contact of stiffness K_c bears obey s³M + γ s²M + s(K + K_c) + ρ K_c = 0. z*
// times this is a cubic with the numbers m = z*Mz, and k, k_c likewise, all ≥ 0. By Routh's criterion no s
// has a positive real part if γ (k + k_c) ≥ ρ k_c, which ρ ≤ γ ensures. What damping is left is at least γ −
// ρ: of a body against itself ρ is γ/2. Tools hold only where selective masses have made contact far softer
// than the body; there ρ is 3γ/4. A body without damping, which never comes to rest, holds nothing: its
// contact keeps energy.
#pragma once

#include <algorithm>

#include "lobe/numerics/lane_mask.h"

namespace lobe {

struct ContactLaw {
  double damping = 0;   // δ: pressure per depth and speed [s]
  double hold = 0;      // ρ [1/s]
  double deepest = 0;   // depth beyond which the pressure grows no more [m]
  double friction = 0;  // μ

  // p [Pa] without damping, by the depth d, what is held h [m], and the stiffness κ [Pa/m].
  template <class T>
  T pressure(const T& depth, const T& held, double stiffness) const {
    return T(stiffness) * bounded(T(depth + held));
  }
  // p [Pa] by the speed −v_n at which the two approach each other as well [m/s].
  template <class T>
  T pressure(const T& depth, const T& held, double stiffness, const T& approach) const {
    const T elastic = pressure(depth, held, stiffness);
    if (damping == 0) return elastic;
    const T damped = elastic + T(damping * stiffness) * approach;
    return pick(is_less(T(0), damped), damped, T(0));
  }
  double energy(double depth, double held, double stiffness) const {  // energy per area [J/m²]
    const double linear = bounded(depth + held);
    return stiffness * linear * (depth + held - linear / 2);
  }
  // The held depth after a time [s].
  double held_after(double time, double depth, double held) const {
    if (depth > 0 && depth + held >= deepest) return held;
    return std::max(0.0, held + hold * time * depth);
  }
  // The share of ξ that friction holds under a pressure: 1, or less where the point slides. `force` is
  // k_t |ξ| [Pa], `square` its square.
  template <class T>
  T held_share(const T& pressure, const T& square, const T& force) const {
    const T most = T(friction) * pressure;
    return pick(is_less(T(most * most), square), T(most / force), T(1));
  }
  static constexpr double slip_share = 0.5;  // k_t/κ

 private:
  template <class T>
  T bounded(const T& depth) const {
    return pick(is_less(depth, T(0)), T(0), pick(is_less(T(deepest), depth), T(deepest), depth));
  }
};

}  // namespace lobe
