// Internal: what is wrong with a document, in words, from the schema itself. Not part of the public
// interface.
//
// A validator's own messages name branches and constraints of the schema. This one names the place, the value
// found and what was expected, and of alternatives only the one that was meant. It understands the keywords
// that scene.schema.json uses; a test compares its verdict with the validator's.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lobe/error.h"

namespace lobe {

// One fault each, at most 100; empty if the document satisfies the schema. The root's place is "".
std::vector<Fault> explain(const nlohmann::json& document, const nlohmann::json& schema);

}  // namespace lobe
