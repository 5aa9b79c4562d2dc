// The report of `lobe check`: what will be run.
#pragma once

#include <string>

#include "lobe/scene/resolve.h"

namespace lobe {

// A text for people: several lines, warnings last. Where a part is much stiffer than others it costs as much
// as building some worlds (pace.h), else as one.
std::string describe(const Scene& scene, const Resolved& resolved);

// The report for programs: one JSON object, indented.
std::string describe_json(const Scene& scene, const Resolved& resolved);

}  // namespace lobe
