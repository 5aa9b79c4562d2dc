// Triangle surfaces out, VTP in, and OBJ with its texture coordinates. Reading other formats and repairing
// surfaces is the meshing part's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lobe/io/mesh_io.h"

namespace lobe {

// Writes by extension: .vtp, .vtu, .obj and .off (exact), .ply (binary, double precision), .stl (binary,
// single precision and without shared vertices, as the format is). The file is whole or absent. `data` of the
// triangles go into .vtp, .vtu and .ply. In .ply they are properties of the faces, with one component only,
// and blanks in names become underscores. Throws InputError for another extension, data that the format does
// not hold, a vertex number out of range, or a folder that cannot be written to.
void write_surface(const std::filesystem::path& file,
                   const Mat3X<double>& points,  // 3 × #vertices [m]
                   const Triangles& triangles,   // 3 × #triangles, counter-clockwise seen from outside
                   const std::vector<DataArray>& data = {});

// Points and polygons as they stand in a file; corners are from 0 and not checked against the points.
struct Polygons {
  std::vector<Vec3d> points;                       // [m]
  std::vector<std::vector<std::int64_t>> corners;  // corners of each polygon
};
Polygons read_vtp(const std::filesystem::path& file);  // strips become triangles, lines and vertices go
// The polygons and strips of a legacy VTK file (.vtk: POLYDATA or UNSTRUCTURED_GRID, 2.0 … 5.1, ascii and
// binary) or an unstructured grid (.vtu). Throws InputError: what is neither, or has tetrahedra only.
Polygons read_vtk_surface(const std::filesystem::path& file);

// A surface for drawing: each corner of a triangle has a point, and perhaps a texture coordinate and a
// normal.
struct TexturedSurface {
  Mat3X<double> points;                              // 3 × #points [m]
  Eigen::Matrix<double, 2, Eigen::Dynamic> texture;  // 2 × #texture coordinates
  Mat3X<double> normals;                             // 3 × #normals
  // 3 × #triangles: numbers of points, texture coordinates and normals from 0; −1: the corner has none.
  Triangles triangles, texture_of, normal_of;
};

// Reads `v`, `vt`, `vn` and `f` of an OBJ file; polygons are cut into fans of triangles; groups, materials,
// lines and curves are left out. Throws InputError, which names the line: what is no OBJ, numbers that are
// not finite, indices out of range, no triangle.
TexturedSurface read_obj(const std::filesystem::path& file);

}  // namespace lobe
