// Private to io/: what the reader of each format hands over.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lobe/file/scanner.h"
#include "lobe/io/mesh_io.h"

namespace lobe::io {

struct RawMesh {
  std::vector<double> coordinates;  // x y z of each vertex [m]
  std::vector<Index> corners;       // four valid vertices of each tetrahedron
  std::vector<int> labels;          // one per tetrahedron, or none
  Index ignored_cells = 0;
};

constexpr std::int64_t max_index = 2147483647;  // of an Index, and of a label

// Checked by prepare(); point and cell data are empty.
MeshFile finish(RawMesh raw, const std::string& name);

RawMesh read_gmsh(const std::string& name, std::string_view bytes);
RawMesh read_medit(const std::string& name, std::string_view bytes);
RawMesh read_vtk_legacy(const std::string& name, std::string_view bytes);
RawMesh read_tetgen(const std::string& node_name, std::string_view node, const std::string& ele_name,
                    std::string_view ele);
MeshFile read_vtu(const std::string& name, std::string_view bytes);

}  // namespace lobe::io
