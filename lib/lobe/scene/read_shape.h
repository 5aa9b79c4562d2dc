// Internal, not part of the public interface: reads shapes of rigid bodies in scenes.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/resolve_parts.h"

namespace lobe {

// Reads the shape of a document that satisfies the schema. A mesh in a file is read later.
RigidShape read_shape(const nlohmann::json& entry);
std::filesystem::path shape_file(const nlohmann::json& entry);  // file of its mesh; empty: it has none
nlohmann::ordered_json write_shape(const RigidShape& shape, const std::filesystem::path& file);
// Reads the mesh if it is in a file, and checks the shape. Returns none if there are faults.
std::optional<RigidShape> resolve_shape(Resolution& resolution, const RigidShape& shape,
                                        const std::filesystem::path& file, const std::string& place);

}  // namespace lobe
