// The mobility of vertices, for force terms that predict what the next step makes of their forces.
#pragma once

#include "lobe/forces/force_term.h"

namespace lobe {

// Sets the inverse mass of each vertex by axis [1/kg]: 0 along axes in which it is held. `inverse_mass` is
// 3 × #vertices then. O(#vertices).
void set_inverse_mass(const BodyView& body, Mat3X<double>& inverse_mass);

}  // namespace lobe
