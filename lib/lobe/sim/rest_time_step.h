// The time step of a mesh before it has a scene.
#pragma once

#include "lobe/fem/body.h"

namespace lobe {

// 2/ω_max [s] of a free mesh of one material at rest: what `lobe info` and `lobe-mesh` print.
double rest_time_step(const TetMesh& mesh, const Elastic& elastic);

}  // namespace lobe
