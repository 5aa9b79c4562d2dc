// Mass added where it lengthens the time step most: at the vertices of the highest frequencies, which are
// few. It acts like other mass of the body, with weight and momentum.
#pragma once

#include <vector>

#include "lobe/types.h"

namespace lobe {

struct MassScaling {
  double added = 0;                          // [kg]
  double share = 0;                          // of the body's mass
  double limit_before = 0, limit_after = 0;  // of the time step at rest [s]
};

// Returns factors ≥ 1 for the vertices' masses. They lower each ω_v² to a common level, for which the added
// mass Σ m_v max(0, ω_v²/level − 1) is just the given one.
std::vector<double> mass_factors(const std::vector<double>& mass,     // [kg]
                                 const std::vector<double>& squares,  // ω_v² [1/s²], 0 where held
                                 double added);                       // [kg]

}  // namespace lobe
