// What a frame costs beyond its steps, from frames of a haptic loop to those of a picture.
#pragma once

#include <string>
#include <vector>

#include "lobe/fem/body.h"
#include "lobe/setup/setup.h"

namespace lobe::bench {

struct FrameCost {
  double frame = 0;       // [s]
  double steps = 0;       // per frame
  double over_steps = 0;  // time of the frames, of that of their steps
  double longest = 0;     // frame [s]
};

// Single precision, one thread, gravity; `seconds` of simulated time each, five times: the middle one counts.
std::vector<FrameCost> frame_costs(const Setup& setup, double seconds);

void print(const std::vector<FrameCost>& costs, const std::string& mesh);
std::string csv(const std::vector<FrameCost>& costs, const std::string& mesh);

}  // namespace lobe::bench
