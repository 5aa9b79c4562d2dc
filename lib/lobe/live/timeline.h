// Records all that is done to the world of a session. That includes going back to earlier states.
#pragma once

#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"

namespace lobe {

// A state from which a session can go on, and the recording that led to it.
template <class Real>
struct SavedSession {
  Checkpoint<Real> state;
  Recording recording;
  static constexpr auto fields = std::tuple(&SavedSession::state, &SavedSession::recording);
};

// Reading throws InputError for a file that is damaged, cut off, of another version or precision.
template <class Real>
void write_session(const std::filesystem::path& file, const SavedSession<Real>& saved);
template <class Real>
SavedSession<Real> read_session(const std::filesystem::path& file);

template <class Real>
class Timeline {
 public:
  // Keeps states that are `apart` [s] from each other: the first one, and as many of the last as fit into
  // `most_bytes`.
  Timeline(World<Real>& world, double apart, std::size_t most_bytes);

  void apply(const Command& command) { recorder_.apply(command); }
  Report advance(double duration);
  // Keeps the present state as well, so that one can go back to exactly here.
  void keep() { checkpoints_.keep_now(world_, recording().commands.size()); }
  // Goes back to the latest state that is at least `seconds` old, else to the first. Grasps of hands then let
  // go, and other tools of hands are taken away.
  void go_back(double seconds);
  void restart();
  SavedSession<Real> save() const { return {world_.save(), recording()}; }
  // Goes on from a saved session, as go_back() does. Throws InputError if it is of another setup, and changes
  // nothing then.
  void restore(SavedSession<Real> saved);

  double can_go_back() const { return world_.time() - first_.state.time; }  // [s]
  std::size_t bytes() const { return checkpoints_.bytes(); }  // memory of all states but the first
  const Recording& recording() const { return recorder_.recording(); }

 private:
  void let_go_of_all();

  World<Real>& world_;
  CommandRecorder<Real> recorder_;
  Checkpoint<Real> first_;
  CheckpointRing<Real> checkpoints_;
};

}  // namespace lobe
