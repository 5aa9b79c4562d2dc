// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include "lobe_mesh/model.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// Everything that a report says about the mesh itself; `model`, options and edges in metres.
void measure(const TetMesh& mesh, const Model& model, const MeshOptions& options, MeshReport& report);

}  // namespace lobe::meshing
