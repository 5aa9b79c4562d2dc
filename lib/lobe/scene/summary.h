// What will be run, as one JSON object: numbers of elements, materials, regions, loads, tools, the pace.
// Internal, not part of the public interface.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "lobe/scene/resolve.h"

namespace lobe {

// Keys end in the unit of their value. describe() (describe.h) makes a text of it.
nlohmann::ordered_json summarise(const Scene& scene, const Resolved& resolved);

}  // namespace lobe
