// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Moves the vertices that limit the explicit time step, or that spoil a dihedral angle, to where they do not.
// A mesher looks at shapes; the step is set by light, stiff vertices, most of them on the surface. A few
// hundred of them moved by a few per cent of an edge raise it by a quarter, in less time than any optimiser
// of the mesher takes.
#pragma once

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

struct RelaxGoal {
  double edge = 1;               // edge by which the time step is measured [m]
  double time_step_star = 0.8;   // time step of every vertex, by its estimate, which is up to 25 % too long
  double min_dihedral = 21;      // [degrees]
  double poisson_ratio = 0.4;    // ratio of the material whose time step it is
  std::size_t most_work = 3000;  // elements evaluated per tetrahedron, against hopeless meshes
};

// Minimises the sum of (goal / value − 1)² over the vertices and dihedral angles that miss the goal, vertex
// by vertex, by trying steps along the axes; vertices of surfaces slide. Never inverts a tetrahedron, never
// makes the sum larger. Serial, the same on every machine but for rounding. Returns how many elements it has
// evaluated.
std::size_t relax(TetMesh& mesh, const Freedom& freedom, const RelaxGoal& goal);

// Says nothing about `on_boundary`.
Bottleneck slowest_vertex(const TetMesh& mesh, const RelaxGoal& goal);

}  // namespace lobe::meshing
