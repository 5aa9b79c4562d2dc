#pragma once

#include "lattice/lattice_worlds.h"

namespace lobe::test {

inline Setup damped_bar(int length, int width, double size = edge) {
  Setup setup = bar(length, width, true, RegionModel::reduced, size);
  setup.damping = 20;
  return setup;
}

}  // namespace lobe::test
