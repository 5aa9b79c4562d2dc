// `lobe solve`: the static equilibrium of a scene.
#pragma once

#include "lobe/run/run.h"

namespace lobe {

// What of a scene a static solution leaves out, one line each.
std::vector<std::string> left_out_of_statics(const Scene& scene, const Setup& setup);

// Writes DIR/solution.vtu (the last equilibrium found, also if it is not at full load) and DIR/report.json.
// A quadratic solution is written on the refined mesh, whose vertices are its nodes. Tools are ignored, and a
// warning says so. Throws InputError for bad input and for files that cannot be written.
RunResult solve_scene(const Scene& scene, const Resolved& resolved, const RunOptions& options);

}  // namespace lobe
