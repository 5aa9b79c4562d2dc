// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe::meshing {

// Largest stable step [s] of central differences with lumped mass, at rest, by the vertex estimate
// 2 / √(max_i λ_max(K_ii) / m_i): within 10 % of the exact limit, one pass over the tetrahedra.
double rest_time_step(const TetMesh& mesh,
                      double lambda,    // [Pa]
                      double mu,        // [Pa]
                      double density);  // [kg/m³]

}  // namespace lobe::meshing
