// Pictures of a run, by the program lobe-picture.
#pragma once

#include <filesystem>
#include <string>

namespace lobe::program {

// Renders a request for pictures, off-screen. Returns an empty string, or why there are no pictures and what
// to do about it.
std::string render_pictures(const std::filesystem::path& request);

// The same for a mesh, coloured by one of its cell data.
std::string draw_cells(const std::filesystem::path& mesh, const std::string& data,
                       const std::filesystem::path& picture);

}  // namespace lobe::program
