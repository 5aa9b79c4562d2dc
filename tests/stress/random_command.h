// What hands and applications may do to a world, at random.
#pragma once

#include "lobe/sim/world.h"
#include "stress/random_setup.h"

namespace lobe::test {

// A command of any kind that is not the world's own. World may refuse it.
template <class Real>
Command random_command(Dice& dice, World<Real>& world, const RandomSetup& body);

}  // namespace lobe::test
