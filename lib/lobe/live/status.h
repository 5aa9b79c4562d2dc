// The status of a session, for other threads. It is made once per frame, after the snapshot of the world
// (snapshot/snapshot.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lobe/live/hand_command.h"

namespace lobe {

// A message of a session: a condition of the world (organ/report.h), or one of these:
//   missed           a ray met nothing, or nothing within the radius can be grasped: the hand is empty
//   slipped          a grasp was pulled at with more than the cap: it has let go
//   controller_gone  its hands have let go
//   tool_gone        the application let go of a hand's tool between two frames: the hand is empty
//   inside           a probe was brought whose position lies in the body
//   blade_inside     a hand's blade cuts and lies wholly in the body: what it cuts opens nowhere
//   refused          a command that is malformed, or concerns a hand or tetrahedron that is not there:
//                    nothing was done
//   haptic_gone, haptic_pose  a haptic device does not answer, or not with a pose (haptic/): its force fades
//   haptic_stale     the session came to no frame for so long that the force of a haptic device was gone
//   stands_still     no step is stable: the simulation pauses; go back, or restart
//   failed           an exception left a frame in its middle: the simulation pauses, and does only what goes
//                    back or restarts. Or a picture could not be passed on
//   went_back, restored  as asked
struct SessionMessage {
  std::uint64_t number = 0;  // counted from 1
  double time = 0;           // simulated time of the first one [s]
  std::string name, text;
  std::string about;  // elements that the text names: "tetrahedron 12", "vertex 3 tetrahedron 12"; or none
  int times = 1;      // how often it came with the same words; the text has the latest figures
};

struct HandStatus {
  int controller = 0;
  HandNumber hand = 0;
  ToolId tool = 0;                      // tool in the world
  const char* type = GraspSetup::type;  // type in a scene
  bool holds = false;                   // whether a grasp has taken hold, or another tool is on
  Index vertices = 0;                   // vertices that a grasp holds
  ToolPose pose = {};                   // pose of where it took hold, or of the tip
  Vec3d force = Vec3d::Zero();          // force on the tool by the body, mean over the last frame [N]
  Vec3d torque = Vec3d::Zero();         // torque about the grasp's centre [N m]
  ToolShape shape = {};
};

struct SessionStatus {
  std::int64_t picture = 0;  // Snapshot::frame of the picture that goes with it
  double time = 0;           // simulated time [s]
  bool is_running = false;   // false: paused
  bool stands_still = false;
  double speed = 1;             // speed asked for, simulated seconds per second
  double real_time_factor = 0;  // speed reached over the last half second; 0 while paused
  double possible_factor = 0;   // speed per second of work: what it could reach without waiting for the clock
  std::int64_t frames = 0;      // frames of the session, over all restarts
  std::int64_t frames_late = 0;
  std::int64_t reruns = 0;     // frames run again with smaller steps
  double can_go_back = 0;      // [s]
  std::uint64_t revision = 0;  // revision of the surface
  std::vector<HandStatus> hands;
  // The sequence of each controller's last command that this state contains.
  std::vector<std::uint64_t> sequences;
  std::shared_ptr<const std::vector<SessionMessage>> messages;  // the last 64, the newest at the end
};

}  // namespace lobe
