// Internal: shapes of rigid bodies in scenes. Not part of the public interface.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/resolve_parts.h"

namespace lobe {

// Of a document that satisfies the schema. A mesh that is in a file is read later: `file` is then set.
RigidShape read_shape(const nlohmann::json& entry, std::filesystem::path& file);
nlohmann::ordered_json write_shape(const RigidShape& shape, const std::filesystem::path& file);
// Read if it is in a file, and checked; none where there are faults.
std::optional<RigidShape> resolve_shape(Resolution& resolution, const RigidShape& shape,
                                        const std::filesystem::path& file, const std::string& place);

}  // namespace lobe
