// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The faces of a mesh that lie on surfaces: its boundary, and what separates its labels.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/nearest.h"

namespace lobe::meshing {

struct InterfaceFace {
  std::array<Index, 3> corners{};  // counter-clockwise seen from outside of `tet`
  Index tet = 0;                   // the first of the one or two tetrahedra that have it
  int label = 0;                   // label of `tet`
  int other = -1;                  // label of the other one; −1: outside
};
std::vector<InterfaceFace> interface_faces(const TetMesh& mesh);  // faces in the order of their vertices
Surface boundary_surface(const TetMesh& mesh);                    // keeps all points of the mesh

// The surfaces between the labels of a mesh: (smaller label, larger label), −1 is outside.
using Interfaces = std::map<std::pair<int, int>, const NearestPoint*>;

// Where each vertex may go.
struct Freedom {
  std::vector<std::vector<const NearestPoint*>>
      slides_on;               // surfaces of each vertex; several where several regions meet
  std::vector<bool> is_fixed;  // whether each vertex is on a feature line

  // The point near `point` that is on everything that vertex v slides on.
  Vec3d on_surfaces(Index v, const Vec3d& point) const;
};

// `features`: lines of points; what lies within a distance of `on_line` [m] from one stays.
Freedom find_freedom(const TetMesh& mesh, const Interfaces& interfaces,
                     const std::vector<Mat3X<double>>& features, double on_line);

// Moves the vertices of curved boundaries and interfaces outwards, so that the mesh has the volume of the
// surface and not that of its chords. The gap between a triangle and a paraboloid through its corners is, in
// the mean, 3/4 of that at its centre; each vertex moves by the mean of that over its triangles, weighted
// with their areas: then Σ area × displacement is the lost volume, and what is flat stays.
void restore_volume(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom);

}  // namespace lobe::meshing
