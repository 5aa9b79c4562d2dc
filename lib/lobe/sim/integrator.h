// Central differences in velocity form, mass-proportional damping γ:
//   v⁺ = ((1 − γΔt/2) v⁻ + Δt f/m) / (1 + γΔt/2),  u⁺ = u + Δt v⁺
// the same scheme as (m/Δt² + γ'/2Δt) x⁺ = R − F_int + (2m/Δt²) x − (m/Δt² − γ'/2Δt) x⁻ with γ' = γ m, [PDA]
// section 3.2, whose damping signs are reversed in print (erratum 3). Stable for Δt < 2/ω_max whatever γ ≥ 0.
// In single precision the velocity form follows double far closer than the position form.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// The highest speeds squared [m²/s²]; of all vertices (infinite if one is not a number), and of those that turned back
// in this step and were faster than before it: what grows in a step beyond the stable one.
template <class Real>
struct Fastest {
  Real all = 0, turned = 0;
};

// Moves every vertex but those with inverse mass 0. v lives half a step before u.
template <class Real>
Fastest<Real> central_difference(const Mat3X<Real>& f, const std::vector<Real>& inverse_mass, Real dt,
                                 Real damping, Mat3X<Real>& u, Mat3X<Real>& v) {
  const Real keep = (1 - damping * dt / 2) / (1 + damping * dt / 2), push = dt / (1 + damping * dt / 2);
  Fastest<Real> fastest;
  bool finite = true;
  for (Index i = 0; i < static_cast<Index>(inverse_mass.size()); ++i) {
    if (inverse_mass[i] == 0) continue;
    const Vec3<Real> before = v.col(i);
    v.col(i) = keep * before + (push * inverse_mass[i]) * f.col(i);
    u.col(i) += dt * v.col(i);
    const Real speed = v.col(i).squaredNorm();
    finite = finite && speed < std::numeric_limits<Real>::max();
    fastest.all = std::max(fastest.all, speed);
    if (before.dot(v.col(i)) < 0 && speed > before.squaredNorm())
      fastest.turned = std::max(fastest.turned, speed);
  }
  if (!finite) fastest.all = std::numeric_limits<Real>::infinity();
  return fastest;
}

}  // namespace lobe
