// Pictures of a run, by the program lobe-picture.
#pragma once

#include <filesystem>
#include <string>

namespace lobe::program {

// Renders a request of Recorder, off-screen. Returns an empty string, or why there are
// no pictures and what to do about it.
std::string render_pictures(const std::filesystem::path& request);

}  // namespace lobe::program
