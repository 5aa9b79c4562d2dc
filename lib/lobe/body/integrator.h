// Central differences in velocity form, mass-proportional damping γ:
//   v⁺ = ((1 − γΔt/2) v⁻ + Δt f/m) / (1 + γΔt/2),  u⁺ = u + Δt v⁺
// the same scheme as (m/Δt² + γ'/2Δt) x⁺ = R − F_int + (2m/Δt²) x − (m/Δt² − γ'/2Δt) x⁻ with γ' = γ m, [PDA]
// section 3.2, whose damping signs are reversed in print (erratum 3). Stable for Δt < 2/ω_max whatever γ ≥ 0.
// In single precision the velocity form follows double far closer than the position form.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

#include "lobe/parallel.h"
#include "lobe/types.h"

namespace lobe {

// The highest squared speeds [m²/s²]: of all vertices (infinite if one is not a number), and of the vertices
// that turned back and became faster in each of the last two steps. Such vertices show that the step is
// longer than the stable one. A wave that passes turns a vertex back only once. No oscillation with ωΔt below
// √3 does so twice in a row; the limit is 2.
template <class Real>
struct Fastest {
  Real all = 0, reversing = 0;
};
using Reversals = std::vector<std::uint8_t>;  // number of steps in a row, per vertex, in which it did so
constexpr std::uint8_t many_reversals = 2;

template <class Real>
struct StepFactors {  // v⁺ = keep v⁻ + push f/m, u⁺ = u + dt v⁺
  StepFactors(Real kick, Real step, Real damping)
      : keep((1 - damping * kick / 2) / (1 + damping * kick / 2)),
        push(kick / (1 + damping * kick / 2)),
        dt(step) {}
  Real keep, push, dt;
};

template <class Real>
struct MovingVertex {
  Index vertex = 0;
  Real inverse_mass = 0;  // [1/kg]
};

// Returns the vertices that move by themselves: those with an inverse mass above 0.
template <class Real>
std::vector<MovingVertex<Real>> moving_vertices(const std::vector<double>& inverse_mass) {
  std::vector<MovingVertex<Real>> moving;
  for (std::size_t v = 0; v < inverse_mass.size(); ++v)
    if (inverse_mass[v] != 0) moving.push_back({static_cast<Index>(v), static_cast<Real>(inverse_mass[v])});
  return moving;
}

// Moves the vertices [begin, end) of the list by one step.
template <class Real>
Fastest<Real> central_difference(const Mat3X<Real>& f, const std::vector<MovingVertex<Real>>& moving,
                                 const StepFactors<Real>& step, Index begin, Index end, Mat3X<Real>& u,
                                 Mat3X<Real>& v, Reversals& reversals) {
  Fastest<Real> fastest;
  bool finite = true;  // no branch within the loop: which vertices turn back is as random as rounding is
  for (Index at = begin; at < end; ++at) {
    const auto [i, inverse_mass] = moving[std::size_t(at)];
    const Vec3<Real> before = v.col(i);
    const Vec3<Real> after = step.keep * before + (step.push * inverse_mass) * f.col(i);
    v.col(i) = after;
    u.col(i) += step.dt * after;
    const Real speed = after.squaredNorm();
    finite = finite & (speed < std::numeric_limits<Real>::max());
    fastest.all = std::max(fastest.all, speed);
    const int reversing = int(before.dot(after) < 0) & int(speed > before.squaredNorm());
    std::uint8_t& count = reversals[std::size_t(i)];
    const int now = reversing * std::min(count + 1, int(many_reversals));
    count = static_cast<std::uint8_t>(now);
    fastest.reversing = std::max(fastest.reversing, Real(now / many_reversals) * speed);
  }
  if (!finite) fastest.all = std::numeric_limits<Real>::infinity();
  return fastest;
}

// Moves all vertices by one step, with a velocity that need not be half a step old. Forces act for the time
// old velocity to that of the new one, which is half a step before the new u.
template <class Real>
Fastest<Real> central_difference(const Mat3X<Real>& f, const std::vector<MovingVertex<Real>>& moving,
                                 Real kick, Real dt, Real damping, Mat3X<Real>& u, Mat3X<Real>& v,
                                 Reversals& reversals, Parallel& parallel) {
  const StepFactors<Real> step(kick, dt, damping);
  Fastest<Real> fastest;
  std::mutex mutex;
  parallel.for_ranges(static_cast<Index>(moving.size()), 2048, [&](Index begin, Index end) {
    const Fastest<Real> of_range = central_difference(f, moving, step, begin, end, u, v, reversals);
    const std::lock_guard lock(mutex);
    fastest.all = std::max(fastest.all, of_range.all);
    fastest.reversing = std::max(fastest.reversing, of_range.reversing);
  });
  return fastest;
}

}  // namespace lobe
