// The JSON Schema (draft 7) of the scene format: scene.schema.json, as part of the library.
#pragma once

#include <string_view>

namespace lobe {

std::string_view scene_schema();

}  // namespace lobe
