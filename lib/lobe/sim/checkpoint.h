// What a world has become since it was built: its edits in order, its state, who holds what. A world of the same setup
// that is given it goes on with the same bits, on any number of threads (docs/stability.md).
#pragma once

#include <deque>
#include <filesystem>
#include <string_view>
#include <vector>

#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
struct Checkpoint {
  std::uint64_t setup = 0;  // fingerprint() of what the world was built from
  std::vector<Edit> history;
  State<Real> state;
  HeldVertices held;
  std::vector<Tools::GraspState> grasps;
  std::vector<Index> body_of;  // World's: which pieces were known; none: one
  std::vector<std::uint8_t> body_was_held;
  Sleep::State sleep;
  Unravelling unravelling;
  FrequencyRatios ratios;
  int mass_degree = 1;
  bool implicit_is_stale = true;
  Mat3X<double> acceleration;  // of implicit dynamics [m/s²], else empty
  std::vector<Condition> pending;
};

// Of what decides how a world moves: mesh, materials, regions, loads, tools …
std::uint64_t fingerprint(const Setup& setup);

// A file that holds a checkpoint. Reading throws InputError for a file that is damaged, cut off, of another version or
// precision; World::restore() for one of another setup.
template <class Real>
void write_checkpoint(const std::filesystem::path& file, const Checkpoint<Real>& checkpoint);
template <class Real>
Checkpoint<Real> read_checkpoint(const std::filesystem::path& file);
// From bytes in memory; `name` is for messages.
template <class Real>
Checkpoint<Real> parse_checkpoint(const std::string& name, std::string_view bytes);

// The last few checkpoints of a world, for an application that wants to go back.
template <class Real>
class CheckpointRing {
 public:
  CheckpointRing(std::size_t most, double apart) : most_(most), apart_(apart) {}  // how many, [s]

  void keep(const World<Real>& world);  // if the last is old enough
  // To the latest checkpoint that is at least `seconds` old, and forgets those after it; false if there is none.
  bool roll_back(World<Real>& world, double seconds);
  std::size_t size() const { return kept_.size(); }

 private:
  std::size_t most_;
  double apart_;
  std::deque<Checkpoint<Real>> kept_;
};

}  // namespace lobe
