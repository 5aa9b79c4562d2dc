// Internal, not part of the public interface: checks a JSON document against the schema of the scene format.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lobe/error.h"

namespace lobe {

// valijson's verdict.
bool satisfies_scene_schema(const nlohmann::json& document);

// Returns all faults against the schema. `name` is what messages call the document as a whole.
std::vector<Fault> schema_faults(const nlohmann::json& document, const std::string& name);

}  // namespace lobe
