// The real beam of silicone of data/measurements/README.md, at rest and in motion.
#pragma once

#include <map>
#include <string>

#include "lobe/mesh/tet_mesh.h"

namespace lobe::validation::silicone {

inline constexpr double length = 0.1, side = 0.03, marker_height = 0.024;  // [m]
inline constexpr double density = 1070, poisson = 0.45, gravity = 9.807;   // [kg/m³], -, [m/s²]
inline constexpr double seen_load = 0.51012, unseen_load = 1.00062;        // [N]

// A column of data/measurements/FILE by case, of the four records, in the unit of the file.
std::map<std::string, double> measured(const std::string& file, const std::string& column);

// Of the marker: on the vertical edge of the side face at the free end, linear between two vertices. Columns
// of u beyond the vertices are not read.
Vec3d at_marker(const TetMesh& mesh, const Mat3X<double>& u);

}  // namespace lobe::validation::silicone
