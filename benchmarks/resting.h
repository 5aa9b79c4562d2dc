// A gesture with rests, played awake and with parts at rest asleep: what sleep gains, and what it costs in
// accuracy.
#pragma once

#include <array>

#include "lobe/setup/setup.h"

namespace lobe::bench {

struct Resting {
  struct Part {                    // of the gesture
    double awake = 0, asleep = 0;  // processor time per simulated second [s]
    double skipped = 0;            // share of the patches' evaluations
  };
  std::array<Part, 2> parts;  // while the tool moves, and while it does not
  double tolerance = 0;       // the scene's `sleep` [m]
  double error = 0;           // largest difference of displacements, of the largest displacement
};
inline constexpr const char* resting_parts[2] = {"moving", "resting"};

// What the setup's first grasp holds is lifted by 20 mm in half a second, kept there, let down as slowly, and
// kept. `rest`: how long each time [s].
Resting play_with_rests(Setup setup, double frame, double rest);

}  // namespace lobe::bench
