// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include "lobe_mesh/model.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// What tetrahedralise() does with the model of its surfaces or of its image.
TetMesh mesh_model(const Model& model, const MeshOptions& options, MeshReport& report);

}  // namespace lobe::meshing
