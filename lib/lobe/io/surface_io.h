// Triangle surfaces out. Reading and repairing surfaces is the meshing part's.
#pragma once

#include <filesystem>

#include "lobe/types.h"

namespace lobe {

// By extension: .obj and .off (text, exact), .ply (binary, double precision), .stl (binary, single precision
// and without shared vertices, as the format is). Whole or absent, like write_vtu(). Throws InputError for
// another extension, a vertex number out of range, or a folder that cannot be written to.
void write_surface(const std::filesystem::path& file,
                   const Mat3X<double>& points,  // 3 × #vertices [m]
                   const Triangles& triangles);  // 3 × #triangles, counter-clockwise seen from outside

}  // namespace lobe
