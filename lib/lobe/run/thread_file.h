// Private to run/: the threads of a frame as a file, and as bodies of a picture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "lobe/forces/threads.h"

namespace lobe {

// VTP, a line for each segment, with the cell arrays `thread` (its number) and `tension` [N].
void write_threads(const std::filesystem::path& file, const std::vector<ThreadLine>& lines);

// A thin capsule for each segment.
void add_threads(nlohmann::ordered_json& bodies, const std::vector<ThreadLine>& lines);

}  // namespace lobe
