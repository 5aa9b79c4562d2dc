// Internal, not part of the public interface: reads selectors of a document that satisfies the schema, and
// writes them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "lobe/scene/scene.h"

namespace lobe {

Vec3d read_vector(const nlohmann::json& row, std::size_t from = 0);  // three numbers from there on
Selector read_selector(const nlohmann::json& object);
nlohmann::ordered_json write_selector(const Selector& selector);

}  // namespace lobe
