// Internal, not part of the public interface: scenes as JSON documents, without text.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "lobe/scene/scene.h"

namespace lobe {

nlohmann::ordered_json write_document(const Scene& scene);  // numbers that are not finite included

// Throws InputError with every fault of the document. `file` as for parse_scene().
Scene read_document(const nlohmann::json& document, const std::filesystem::path& file);

}  // namespace lobe
