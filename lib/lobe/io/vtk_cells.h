// Private to io/: the cells of a VTK file, legacy or XML, reduced to tetrahedra.
#pragma once

#include "lobe/io/raw_mesh.h"
#include "lobe/io/surface_io.h"

namespace lobe::io {

struct VtkCells {
  std::vector<double> connectivity;  // vertices of all cells, one cell after the other
  std::vector<double> ends;          // end of each cell in `connectivity`
  std::vector<double> types;         // 10 is a tetrahedron, 24 one of ten nodes
};

void add_points(const std::vector<double>& coordinates, Polygons& polygons);
// Appends triangles, quadrangles, polygons, triangles of strips, and the corners of six-node triangles.
// Corners are not checked against the points.
void add_polygons(const VtkCells& cells, const std::string& place, Polygons& polygons);

struct TakenCells {
  std::vector<std::size_t> tets;       // which cells are tetrahedra
  std::vector<std::size_t> triangles;  // which cells are triangles
  std::vector<std::size_t> begins;     // first place of each of these triangles in the connectivity
};

// Appends the tetrahedra to `raw`, and counts all others but triangles, which may be in groups.
TakenCells take_cells(const VtkCells& cells, const std::string& place, RawMesh& raw);

Polygons read_vtu_surface(const std::string& name, std::string_view bytes);

// One value per cell.
struct CellArray {
  std::string name;
  std::vector<double> values;
  bool is_whole = false;  // the array is of whole numbers, by its type
};

// Takes the labels of the tetrahedra from the array `wanted`. Without such a wish from the one that has a
// known name, else from the only one of whole numbers. Notes of `raw` say which, or between which it cannot
// choose. Triangles for which that array has another value than 0 become the group of that number. Returns
// its name, empty if it took none.
std::string take_labels(const std::vector<CellArray>& arrays, const VtkCells& cells, const TakenCells& taken,
                        const std::string& place, std::string_view wanted, RawMesh& raw);

}  // namespace lobe::io
