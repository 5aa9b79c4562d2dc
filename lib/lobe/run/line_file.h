// Private to run/: threads and strands of a frame as files, and as bodies of a picture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "lobe/forces/term_lines.h"

namespace lobe {

// VTP, a line for each segment, with the cell arrays `number` (TermLines::number), `tension` [N] and, of
// attachments, `damage`.
void write_lines(const std::filesystem::path& file, const std::vector<TermLines>& lines);

// A thin capsule for each segment.
void add_lines(nlohmann::ordered_json& bodies, const std::vector<TermLines>& lines);

}  // namespace lobe
