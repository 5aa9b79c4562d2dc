// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Gives each label of a mesh its volume.
#pragma once

#include <vector>

#include "lobe_mesh/interfaces.h"

namespace lobe::meshing {

// Volumes of the labels 0 … count − 1.
std::vector<double> label_volumes(const TetMesh& mesh, int count);

// Largest error, as a part of its goal, of the labels that have tetrahedra.
double largest_volume_error(const TetMesh& mesh, const std::vector<double>& goals);

constexpr double accepted_volume_error = 0.02;  // relative error of a label's volume

// Moves the vertices of boundaries and interfaces until the volume of every label k is goals[k] but for the
// accepted error; a mesh where it is already stays bit for bit. The displacement
//   u_v = w_v Σ_k p_k ∂V_k/∂x_v,   Σ_v ∂V_j/∂x_v · u_v = what label j misses,
// with k and j over the labels that miss some, is the smallest in the norm Σ |u_v|²/w_v. The weight w_v is
// the mean height of the surface over the chords of the triangles at v, by the area there: what is flat
// stays, and the volume is put back where it was lost. No vertex goes farther than a quarter of an edge from
// the surface, no tetrahedron is flattened, and the boundary does not run into itself; what cannot be reached
// is left. O(#tetrahedra log #tetrahedra), and O(#faces log #triangles) a round.
void match_volumes(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom,
                   const std::vector<double>& goals);  // [m³] of each label

}  // namespace lobe::meshing
