// Internal, not part of the public interface: validates a document against a schema, and says in words what
// is wrong with it, from the schema itself.
//
// A validator's own messages name branches and constraints of the schema. These messages name the place, the
// value found and what was expected. Of several alternatives they name only the one that was meant. It
// understands the keywords that scene.schema.json uses; tests compare its verdict with a validator's. A
// document made in code may also have what no text has, and is refused for it: numbers that are not finite.
// "removed" lists keys that an earlier format had, each with what to do instead.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lobe/error.h"

namespace lobe {

// One fault each, at most 100; empty if the document satisfies the schema. The root's place is "".
std::vector<Fault> explain(const nlohmann::json& document, const nlohmann::json& schema);

// All faults of a scene's document. `name` is what messages call the document as a whole.
std::vector<Fault> schema_faults(const nlohmann::json& document, const std::string& name);

}  // namespace lobe
