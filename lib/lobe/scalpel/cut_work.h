// The work of a blade in one step.
#pragma once

#include "lobe/types.h"

namespace lobe {

struct CutWork {
  double energy = 0;             // [J]
  Vec3d moment = Vec3d::Zero();  // energy times place, summed over the opened faces [J m]
};

}  // namespace lobe
