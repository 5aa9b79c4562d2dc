// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Groups of triangles that a surface file names (a capsule, the cut through a vessel), and the faces of a
// mesh that belong to them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe/io/mesh_io.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

struct NamedSurface {
  std::string name;  // empty: of no group
  Surface surface;
};

// The groups of an OBJ file (`g`, or `o`, or `usemtl`: the first of them that has several) or the solids of
// an ascii STL file, in the order in which they begin. Another file, or one with fewer than two of them, is
// one surface without a name. Throws InputError as read_surface() does.
std::vector<NamedSurface> read_groups(const std::filesystem::path& file);

// The faces of a mesh's boundary and between its labels, each in the group whose triangles are nearest to its
// centre. Groups are numbered from 1 as they come; those of no name are left out, and those of no face.
// O(#faces #groups log #triangles).
std::vector<SurfaceGroup> groups_of_faces(const TetMesh& mesh, const std::vector<NamedSurface>& groups);

}  // namespace lobe::meshing
