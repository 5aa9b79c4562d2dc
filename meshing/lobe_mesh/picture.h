// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <filesystem>
#include <string>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// Draws, side by side, the boundary of the mesh, the mesh cut open and coloured by the smallest dihedral
// angle of each tetrahedron, and the histogram of all dihedral angles, by lobe-picture. Returns "",
// or why there is no picture.
std::string draw_picture(const std::filesystem::path& file,  // .png
                         const TetMesh& mesh, const MeshReport& report);

}  // namespace lobe::meshing
