// What a watch does to a world goes through this: the world's own apply(), or that of who keeps a record of
// the commands.
#pragma once

#include <functional>

#include "lobe/sim/command.h"

namespace lobe {

using Steering = std::function<void(const Command&)>;

// To the world itself.
template <class World>
Steering steering_of(World& world) {
  return [&world](const Command& command) { world.apply(command); };
}

}  // namespace lobe
