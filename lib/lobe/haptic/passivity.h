// Keeps a haptic loop passive: it never gives the hand more energy than the hand has put in.
//
// A wall of stiffness K and damping B that is sampled every T is passive on a device of damping b if
// b > K T/2 + |B| (Colgate & Brown 1994; Colgate & Schenkel 1997). The observer sums the energy that goes
// into the simulation, and the energy that the device itself dissipates. The controller adds damping if more
// has come out than went in (Hannaford & Ryu 2002).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lobe/haptic/device.h"

namespace lobe {

// The stiffest coupling that is passive [N/m]: 2 (b − |B|)/T.
double passive_stiffness(double device_damping, double coupling_damping, double tick);

class Passivity {
 public:
  // `highest_damping`: the most that the controller adds [N s/m]. It does nothing before more than
  // `passivity_deadband` [J] has come out.
  Passivity(double device_damping, double highest_damping, double passivity_deadband = 0)
      : device_damping_(device_damping), highest_damping_(highest_damping), deadband_(passivity_deadband) {}

  // Call it when the device has moved by `way` while it felt `force` for `dt`.
  void observe(const Vec3d& force, const Vec3d& way, double dt);
  // The energy that springs can have stored at most [J]. Any more that went in was dissipated and cannot come
  // back.
  void forget_above(double stored);
  // Begins again with springs that have stored this energy [J].
  void restart(double stored) { energy_ = stored; }
  // Energy that has come out is forgotten with a time constant of 0.5 s, so that a hand at rest is not
  // damped for ever.
  void forget_debts(double dt) { energy_ += std::min(0.0, energy_) * std::expm1(-2 * dt); }
  // The damping that takes away the surplus energy at this velocity of the device [N s/m]; 0 without a
  // surplus.
  double damping(const Vec3d& velocity, double dt) const;

  double energy() const { return energy_; }  // energy that went in and has not come out [J]

 private:
  double device_damping_, highest_damping_, deadband_;
  double energy_ = 0;
};

}  // namespace lobe
