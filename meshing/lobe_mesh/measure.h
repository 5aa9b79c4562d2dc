// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include "lobe_mesh/model.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

constexpr double kept_volume = 5;  // [%] by which the volume of a label may differ without a word
double largest_volume_error(const MeshReport& report);  // [%] of the labels that have tetrahedra

// Smallest angle, altitude and time step, each over that of the gate: the least of them.
double shape_of(const MeshReport& report);

// Everything that a report says about the mesh itself; `model`, options and edges in metres.
void measure(const TetMesh& mesh, const Model& model, const MeshOptions& options, MeshReport& report);

}  // namespace lobe::meshing
