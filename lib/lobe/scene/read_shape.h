// Internal, not part of the public interface: reads shapes of rigid bodies in scenes.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/resolve_parts.h"

namespace lobe {

// The file of a shape in a document that satisfies the schema; empty: it has none. Its mesh is read later.
std::filesystem::path shape_file(const nlohmann::json& entry);
nlohmann::ordered_json write_shape(const RigidShape& shape, const std::filesystem::path& file);
// Reads the mesh if it is in a file, and checks the shape. Returns none if there are faults.
std::optional<RigidShape> resolve_shape(Resolution& resolution, const RigidShape& shape,
                                        const std::filesystem::path& file, const std::string& place);

}  // namespace lobe
