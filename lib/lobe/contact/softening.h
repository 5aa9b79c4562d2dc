// By how much contact is softer beside selective masses. The stiffness K_c of contact all over the surface is
// first that beside lumped masses (contact_surface.h). It is lowered until
//   λ_max(C (K + K_c)) ≤ (1 + most_added) ω_max²,
// with C the inverse mass matrix (time/selective_mass.h) and K the stiffness of the body at rest. Contact on
// a part of the surface gives no higher frequency. Setup::safety has room for the share most_added.
//
// The body is as it was set up: whole, expanded, awake, and held by its boundary conditions alone. So there
// is one number per degree, whenever contact is first seen and whatever tools have done before. Cuts change
// λ_max little.
#pragma once

#include "lobe/contact/contact_surface.h"
#include "lobe/time/frequency_ratios.h"
#include "lobe/time/inertia.h"

namespace lobe {

// Returns the share of the stiffness that is left, at most 1. `inertia` has the scaling of masses, and
// nothing else. Costs up to 320 products with K and C.
template <class Real>
double find_softening(const Setup& setup, Inertia<Real> inertia, int degree, const RestFrequencies& at_rest,
                      Parallel& parallel);

}  // namespace lobe
