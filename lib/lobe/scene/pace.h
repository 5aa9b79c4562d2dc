// Which part of a body sets the length of all steps, and what own steps spare (time/own_steps.h). An estimate
// at rest.
#pragma once

#include <optional>
#include <vector>

#include "lobe/setup/setup.h"
#include "lobe/time/levels.h"

namespace lobe {

struct Pace {
  double time_step = 0;          // stable step of all, 2/ω_max [s]
  std::vector<Level> materials;  // per material: the highest level of its patches
  double evaluations = 1;        // of forces, as a share of those that one step for all takes
};

// Returns the pace that own steps take in a body at rest with its attachments, but without what touches it.
// Returns nothing where own steps would spare less than a fifth of the work, or do not go with what the setup
// asks for (setup/exclusions.h), and where nothing moves. Costs as much as building a world without tools
// and some hundred steps in it.
std::optional<Pace> pace_at_rest(const Setup& setup);

}  // namespace lobe
