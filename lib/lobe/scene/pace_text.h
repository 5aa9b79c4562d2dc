// What `lobe check` says of the pace of each material (pace.h).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lobe/scene/resolve.h"

namespace lobe {

// Null where own steps would spare less than a quarter of the evaluations, or nothing is known of them: with
// implicit steps, selective masses, pre-computed or reduced regions, or automatic ones that are not chosen
// yet.
nlohmann::ordered_json summarise_pace(const Scene& scene, const Resolved& resolved);

std::string pace_lines(const nlohmann::ordered_json& pace);

}  // namespace lobe
