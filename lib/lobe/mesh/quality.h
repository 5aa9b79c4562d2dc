// How good a tetrahedral mesh is for explicit dynamics.
#pragma once

#include <array>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct Quality {
  double volume = 0;                           // [m³]
  double smallest_tet_volume = 0;              // [m³]
  double min_dihedral = 0;                     // [degrees]
  double max_dihedral = 0;                     // [degrees]
  double median_min_dihedral = 0;              // median over tetrahedra of the smallest dihedral [degrees]
  std::array<Index, 18> dihedral_histogram{};  // all dihedral angles in bins of 10 degrees
  double smallest_altitude = 0;                // [m]
  double smallest_altitude_ratio = 0;          // smallest altitude of a tetrahedron / its longest edge
  Index worst_tet = 0;                         // the tetrahedron with the smallest altitude ratio
  double mean_edge = 0;                        // [m], over tetrahedra's edges
  Vec3d box_min = Vec3d::Zero(), box_max = Vec3d::Zero();  // [m]
};

std::array<double, 6> dihedral_angles(
    const Mat34<double>& corners);  // [degrees], in the order of edge_corners
std::array<double, 4> altitudes(
    const Mat34<double>& corners);  // [m], altitude above the face opposite to each corner
Quality mesh_quality(const TetMesh& mesh);

}  // namespace lobe
