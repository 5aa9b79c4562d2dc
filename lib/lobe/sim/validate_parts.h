// The parts of validate() that look into regions, tools, blades and sleep.
#pragma once

#include "lobe/sim/world.h"

namespace lobe {

// Throws BrokenInvariant, which names what does not fit.
template <class Real>
void validate_parts(const World<Real>& world);

}  // namespace lobe
