// Private to io/: the cells of a VTK file, legacy or XML, reduced to tetrahedra.
#pragma once

#include "lobe/io/raw_mesh.h"

namespace lobe::io {

struct VtkCells {
  std::vector<double> connectivity;  // vertices of all cells, one cell after the other
  std::vector<double> ends;          // of each cell in `connectivity`
  std::vector<double> types;         // 10 is a tetrahedron
};

// Names under which labels are looked for, the first that is present wins.
constexpr const char* label_names[] = {"label", "gmsh:physical", "medit:ref", "CellEntityIds"};

// Appends the tetrahedra to `raw`; returns which cells they are.
std::vector<std::size_t> add_tetrahedra(const VtkCells& cells, const std::string& place, RawMesh& raw);

// Labels of the tetrahedra from one value per cell.
std::vector<int> labels_of(const std::vector<double>& values, const std::vector<std::size_t>& tets,
                           const std::string& place);

}  // namespace lobe::io
