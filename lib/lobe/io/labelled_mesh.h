// Tetrahedral meshes whose labels have a name of their own.
#pragma once

#include "lobe/io/mesh_io.h"

namespace lobe {

// read_mesh() of a .vtu or .vtk file, with labels from the cell array of that name. Throws InputError if the
// file has no such array, or its values are no whole numbers below 2^31.
MeshFile read_labelled_mesh(const std::filesystem::path& file, const std::string& labels);

}  // namespace lobe
