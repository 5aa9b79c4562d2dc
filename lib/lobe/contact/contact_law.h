// The pressure of a contact as a function of its depth.
#pragma once

#include <algorithm>

namespace lobe {

struct ContactLaw {
  double damping = 0;  // δ: pressure per depth and speed [s]
  double deepest = 0;  // [m]: beyond, the pressure grows no more
  double pressure(double depth, double stiffness) const { return stiffness * std::min(depth, deepest); }
};

}  // namespace lobe
