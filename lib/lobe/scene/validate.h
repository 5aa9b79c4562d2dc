// Internal: a JSON document against the schema of the scene format. Not part of the public interface.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lobe/error.h"

namespace lobe {

// valijson's verdict.
bool satisfies_scene_schema(const nlohmann::json& document);

// Every departure from the schema; `name` is what the document as a whole is called.
std::vector<Fault> schema_faults(const nlohmann::json& document, const std::string& name);

}  // namespace lobe
