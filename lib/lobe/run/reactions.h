// The forces with which boundary conditions hold a body, as reports have them. Private to this folder.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/held_forces.h"

namespace lobe {

// The force on the body of each entry of the boundary: {"entry": "/boundary/0", "force": [x, y, z]} [N].
// `reactions`: 3 × #vertices [N].
nlohmann::ordered_json reactions_json(const std::vector<HeldEntry>& entries, const Elements& elements,
                                      const Mat3X<double>& reactions);

}  // namespace lobe
