// Writes a scene as JSON.
#pragma once

#include <string>

#include "lobe/scene/scene.h"

namespace lobe {

// Writes every key, with defaults filled in and materials by their Lamé coefficients. parse_scene() of the
// text gives the same scene to the last bit. A number that is not finite becomes null, which parse_scene()
// refuses.
std::string to_json(const Scene& scene);

}  // namespace lobe
