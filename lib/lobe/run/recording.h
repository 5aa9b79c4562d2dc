// A recording lists the commands that a world was given, with a digest of the state after each. A replay on a
// world of the same setup must give the same bits, on any number of threads. Going back to an earlier state
// is an entry too; what was done before stays in the recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include "lobe/run/command_log.h"
#include "lobe/sim/checkpoint.h"

namespace lobe {

struct Recording {
  std::uint64_t setup = 0;  // fingerprint() of the world's setup
  double sleep = 0;         // Setup::sleep of the world [m], which a scene may leave to its sessions
  bool in_double = false;
  CommandLog commands;
  static constexpr auto fields =
      std::tuple(&Recording::setup, &Recording::sleep, &Recording::in_double, &Recording::commands);
};

// Visits the commands that led to the state of the world at the end, without what was undone by going back
// and without GoBack: visit(command, times), where equal frames are one.
void visit_to_the_end(const Recording& recording,
                      const std::function<void(const Command&, std::size_t)>& visit);

template <class Real>
std::uint64_t digest(World<Real>& world);

// Frames whose digest is noted. all: each frame. some: in a run of frames with nothing but poses of tools in
// between, the 1st, 2nd, 4th … and each 16th; in one with nothing in between, each 1024th. A replay
// compares where a digest is noted.
enum class NotedFrames { all, some };

// Passes commands on to a world and records them.
template <class Real>
class CommandRecorder {
 public:
  explicit CommandRecorder(World<Real>& world, NotedFrames noted = NotedFrames::all);

  void apply(const Command& command);
  Report advance(double duration);
  // Goes back to a checkpoint of this world that was made when the recording had `entries` entries.
  void go_back(const Checkpoint<Real>& checkpoint, std::size_t entries);
  // Goes on from the state at the end of another recording of the same setup, and from that recording. Throws
  // InputError if the two do not belong together; nothing has changed then.
  void go_on(const Checkpoint<Real>& checkpoint, Recording recording);
  const Recording& recording() const { return recording_; }

 private:
  bool notes_next_frame();

  World<Real>& world_;
  Recording recording_;
  NotedFrames noted_;
  std::uint32_t frames_ = 0;       // frames since something else than a pose
  std::uint32_t frames_idle_ = 0;  // frames since any command
};

struct ReplayResult {
  std::size_t commands = 0;  // commands up to the first one after which the bits differ
  bool same = true;          // whether all bits were the same
  double time = 0;           // time of the world at the end [s]
};

// The setup of a scene as that of the recorded world: to build the world from that a replay needs.
Setup as_recorded(const Recording& recording, Setup setup);
// Plays a recording on a world as it was when the recording began; throws InputError for one of another setup
// or precision. Stops at the first command after which the state differs. It stores the states to which the
// recording goes back.
template <class Real>
ReplayResult replay(const Recording& recording, World<Real>& world);

// Reading throws InputError for a file that is damaged, cut off or of another version.
void write_recording(const std::filesystem::path& file, const Recording& recording);
Recording read_recording(const std::filesystem::path& file);
Recording parse_recording(const std::string& name, std::string_view bytes);

}  // namespace lobe
