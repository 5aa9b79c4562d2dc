// Small bodies of any region models and options.
#pragma once

#include "lobe/setup/setup.h"
#include "stress/dice.h"

namespace lobe::test {

inline constexpr double cell = 0.01;  // of the mesh [m]

struct RandomSetup {
  Setup setup;
  double size = 0;  // edge of the cube that the body is [m]
};
// World may refuse it: options that exclude each other come together.
RandomSetup random_setup(Dice& dice);

}  // namespace lobe::test
