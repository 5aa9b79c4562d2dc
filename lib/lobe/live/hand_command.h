// What hands and their controllers ask of a session, as values of a fixed size. The session turns them into
// commands of the world (sim/command.h), which are what is recorded.
#pragma once

#include <cstdint>
#include <memory>

#include "lobe/sim/command.h"

namespace lobe {

// A hand holds one tool at a time. Its number is chosen by the controller; those of two controllers are
// different hands.
using HandNumber = std::uint32_t;

struct HandCommand {
  enum class Kind : std::uint8_t {
    // Holds what lies within `radius` of where the ray from `position` along `direction` enters the body.
    take_at_ray,
    take_at_point,  // holds what lies within `radius` of `position`
    bring_cautery,  // with a tip of `radius`, off, to `position`
    bring_scalpel,  // off; its tip to `position`, and `direction` leads from there to the heel [m]
    lead,           // the hand is to go to `position`, turned by `orientation` since it took hold
    burn,           // the cautery or scalpel on or off, as `on` says
    let_go,         // of what the hand holds; a cautery or scalpel is taken away
    // Edits the body, by `body_edit`: RemoveTets, SetRegion, SetForces, … but no tool's command, nor Advance.
    edit,
    run,      // as `on` says; false: the simulation pauses
    step,     // one frame, while paused
    speed,    // `value` simulated seconds per second of the clock, 0.001 … 100
    restart,  // as it was at the start; all hands let go
    back,     // by at least `value` seconds; all hands let go
    alive     // nothing, but that the controller is there
  };
  Kind kind = Kind::alive;
  bool on = false;
  HandNumber hand = 0;
  std::uint64_t sequence = 0;               // the controller's own count, told back in SessionStatus
  Vec3d position = Vec3d::Zero();           // [m]
  Vec3d direction = Vec3d::Zero();          // of any length but 0; of a ray
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  double radius = 0;                        // [m]
  double value = 0;
  std::shared_ptr<const Command> body_edit = {};  // of `edit`
};

const char* name(HandCommand::Kind kind);

}  // namespace lobe
