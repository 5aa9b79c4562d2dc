// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace lobe::meshing {

// Names of the segments of 3D Slicer by the labels that read_label_image() gives them; none for other files.
// Reads the voxels, as the labels of segments in layers depend on them. Throws InputError as that does.
std::map<int, std::string> segment_names(const std::filesystem::path& file);

}  // namespace lobe::meshing
