// What the force term of needles (forces/needles.h) sees of a needle that moves through a frame.
#pragma once

#include <span>
#include <string>

#include "lobe/setup/needle_shape.h"
#include "lobe/setup/tool_path.h"

namespace lobe {

struct NeedleBody {
  int tool = 0;  // ToolId; in tests also numbers below 1, which are no tools
  std::string name;
  NeedleSettings settings;
  double appears = 0, goes = 0;     // times when it comes and when it goes [s]
  std::span<const PathPoint> path;  // rows of its path around the frame; between them it moves uniformly
};

}  // namespace lobe
