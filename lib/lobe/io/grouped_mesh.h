// Tetrahedral meshes out with groups of triangles and the names of groups.
#pragma once

#include "lobe/io/mesh_io.h"

namespace lobe {

struct Groups {
  std::vector<SurfaceGroup> surfaces;      // each of another number above 0
  std::map<int, std::string> label_names;  // of labels above 0
  bool empty() const { return surfaces.empty() && label_names.empty(); }
};

// Whether the format of that extension holds groups of triangles: .msh, .msh2 and .mesh, which has no names.
bool holds_groups(const std::filesystem::path& file);

// write_mesh() with groups, as read_mesh() reads them. Throws InputError where the format holds none.
void write_grouped_mesh(const std::filesystem::path& file, const TetMesh& mesh, const Groups& groups);

}  // namespace lobe
