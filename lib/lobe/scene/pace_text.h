// What `lobe check` says of the pace of each material (pace.h).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lobe/scene/resolve.h"

namespace lobe {

// Null where own steps would spare less than a fifth of the work, or do not go with the scene, and for
// automatic regions that are not chosen yet. Where the scene asks for own steps, it is said that they spare
// nothing.
nlohmann::ordered_json summarise_pace(const Scene& scene, const Resolved& resolved);

std::string pace_lines(const nlohmann::ordered_json& pace);

}  // namespace lobe
