// Private to io/: what the reader of each format hands over.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lobe/file/scanner.h"
#include "lobe/io/mesh_io.h"

namespace lobe::io {

struct RawMesh {
  std::vector<double> coordinates;       // x y z of each vertex [m]
  std::vector<Index> corners;            // four valid vertices of each tetrahedron
  std::vector<int> labels;               // one per tetrahedron, or none
  std::map<std::string, Index> ignored;  // cells that are no tetrahedra, by their kinds
  std::vector<Index> middles;            // vertices in the middle of edges, of which only the ends are taken
  Index ten_node = 0;                    // tetrahedra that have such vertices
  std::vector<std::string> notes;        // what MeshFile says
  std::map<int, SurfaceGroup> surfaces;  // groups by number
  std::map<int, std::string> label_names;
};

constexpr std::int64_t max_index = 2147483647;  // largest Index, and largest label

// Adds the corners of a tetrahedron of ten valid vertices, corners first.
void add_ten_node(const std::vector<Index>& nodes, RawMesh& raw);

// Checked by prepare(); point and cell data are empty. `kept`: if not null, it gets the vertices that are
// left where some are left out; empty: all of them.
MeshFile finish(RawMesh raw, const std::string& name, std::vector<Index>* kept = nullptr);

RawMesh read_gmsh(const std::string& name, std::string_view bytes);
RawMesh read_medit(const std::string& name, std::string_view bytes);
// `labels`: the cell array that has them; empty: see mesh_io.h.
RawMesh read_vtk_legacy(const std::string& name, std::string_view bytes, std::string_view labels = {});
RawMesh read_tetgen(const std::string& node_name, std::string_view node, const std::string& ele_name,
                    std::string_view ele);
MeshFile read_vtu(const std::string& name, std::string_view bytes, std::string_view labels = {});

}  // namespace lobe::io
