// Tetrahedral meshes out with groups of triangles and the names of groups.
#pragma once

#include "lobe/io/mesh_io.h"

namespace lobe {

struct RefinedMesh;

struct Groups {
  std::vector<SurfaceGroup> surfaces;      // each of another number above 0
  std::map<int, std::string> label_names;  // Gmsh's formats take none of label 0
  bool empty() const { return surfaces.empty() && label_names.empty(); }
};

// Returns a surface on a refinement: four triangles for each whose edges are edges of the old mesh; others
// are left out.
std::vector<std::array<Index, 3>> refined_triangles(const std::vector<std::array<Index, 3>>& triangles,
                                                    const TetMesh& old, const RefinedMesh& fine);

// Whether the format of that extension holds groups of triangles: .vtu, .msh, .msh2 and .mesh, which has no
// names.
bool holds_groups(const std::filesystem::path& file);

// write_mesh() with groups, as read_mesh() reads them. Throws InputError where the format holds none.
void write_grouped_mesh(const std::filesystem::path& file, const TetMesh& mesh, const Groups& groups);

// write_vtu() with groups: their triangles are cells with the group's number as label, and 0 in all other
// arrays; the names stand in the file's field data.
void write_grouped_vtu(const std::filesystem::path& file, const TetMesh& mesh, const Groups& groups,
                       const std::vector<DataArray>& point_data, const std::vector<DataArray>& cell_data);

}  // namespace lobe
