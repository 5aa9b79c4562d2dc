// The function by which a watch sends commands to a world: World::apply(), or one that also records them.
#pragma once

#include <functional>

#include "lobe/sim/command.h"

namespace lobe {

using CommandSink = std::function<void(const Command&)>;

// Sends commands to the world itself.
template <class World>
CommandSink sink_of(World& world) {
  return [&world](const Command& command) { world.apply(command); };
}

}  // namespace lobe
