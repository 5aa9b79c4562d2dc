// The pressure of a contact as a function of its depth.
//
//   p = κ ⟨d + h⟩,  ḣ = ρ d,  0 ≤ h,   where d + h ≤ `deepest`
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

namespace lobe {

struct ContactLaw {
  double damping = 0;  // δ: pressure per depth and speed [s]
  double hold = 0;     // ρ [1/s]
  double deepest = 0;  // [m]: beyond, the pressure grows no more

  double pressure(double depth, double held, double stiffness) const {  // [Pa]
    return stiffness * std::clamp(depth + held, 0.0, deepest);
  }
  double energy(double depth, double held, double stiffness) const {  // per area [J/m²]
    const double linear = std::clamp(depth + held, 0.0, deepest);
    return stiffness * linear * (depth + held - linear / 2);
  }
  // What is held after a time [s].
  double held_after(double time, double depth, double held) const {
    if (depth > 0 && depth + held >= deepest) return held;
    return std::max(0.0, held + hold * time * depth);
  }
};

}  // namespace lobe
