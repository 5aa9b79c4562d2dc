// Internal: selectors from a document that satisfies the schema. Not part of the public interface.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "lobe/scene/scene.h"

namespace lobe {

Vec3d read_vector(const nlohmann::json& row);
Selector read_selector(const nlohmann::json& object);

}  // namespace lobe
