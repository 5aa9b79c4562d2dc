// Commands of hands and their controllers to a session, as values of a fixed size. The session turns them
// into commands of the world (sim/command.h) and records those.
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
    bring,          // the tool that `tool` says, off; `position` is that of the hand, usually of the tip
    lead,     // moves the hand to `position`, turned by `orientation` since it took hold or brought its tool
    turn_on,  // turns it on or off, as `on` says: a cautery burns, a scalpel cuts, jaws close
    let_go,   // a grasp lets go; a tool that the hand has brought is removed
    edit,     // edits the body by `body_edit`: RemoveTets, SetRegion, SetForces and others
    run,      // runs as `on` says; false: the simulation pauses
    step,     // makes one frame, while paused
    speed,    // sets the speed: `value` simulated seconds per second of the clock, 0.001 … 100
    restart,  // goes back to the start; all hands let go
    back,     // goes back by at least `value` seconds; all hands let go
    alive     // does nothing, but shows that the controller is there
  };
  Kind kind = Kind::alive;
  bool on = false;
  HandNumber hand = 0;
  std::uint64_t sequence = 0;               // the controller's own count; SessionStatus reports it back
  Vec3d position = Vec3d::Zero();           // [m]
  Vec3d direction = Vec3d::Zero();          // direction, of any length but 0
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  double radius = 0;                        // [m]
  double value = 0;
  std::shared_ptr<const Edit> body_edit = {};  // edit for `edit`
  std::shared_ptr<const BringTool> tool = {};  // tool for `bring`; the hand's name replaces its own
};

const char* name(HandCommand::Kind kind);

// A hand brings a tool; its position is that of the tip.
HandCommand bring_tool(HandNumber hand, const Vec3d& position, BringTool tool);

}  // namespace lobe
