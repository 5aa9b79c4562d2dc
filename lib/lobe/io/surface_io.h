// Triangle surfaces out, and VTP in. Reading other formats and repairing surfaces is the meshing part's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lobe/io/mesh_io.h"

namespace lobe {

// By extension: .vtp, .vtu, .obj and .off (exact), .ply (binary, double precision), .stl (binary, single precision
// and without shared vertices, as the format is). Whole or absent, like write_vtu(). `data` of the triangles go
// into .vtp, .vtu and .ply; there as properties of the faces, blanks in names as underscores, one component only.
// Throws InputError for another extension, data that the format does not hold, a vertex number out of range, or a
// folder that cannot be written to.
void write_surface(const std::filesystem::path& file,
                   const Mat3X<double>& points,  // 3 × #vertices [m]
                   const Triangles& triangles,   // 3 × #triangles, counter-clockwise seen from outside
                   const std::vector<DataArray>& data = {});

// Points and polygons as they stand in a file; corners are from 0 and not checked against the points.
struct Polygons {
  std::vector<Vec3d> points;                       // [m]
  std::vector<std::vector<std::int64_t>> corners;  // of each polygon
};
Polygons read_vtp(const std::filesystem::path& file);  // triangle strips, lines and vertices are left out

}  // namespace lobe
