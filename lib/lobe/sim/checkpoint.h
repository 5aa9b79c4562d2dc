// A checkpoint holds all that has changed in a world since it was built: its edits in order, its state, its
// held and grasped vertices. Another world of the same setup can restore it. From there both compute the same
// bits, on any number of threads (docs/stability.md).
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lobe/sim/world.h"
#include "lobe/time/own_steps.h"

namespace lobe {

template <class Real>
struct Checkpoint {
  std::uint64_t setup = 0;  // fingerprint() of the setup of the world
  State<Real> state;
  History history;
  HeldVertices held;
  Tools::State tools;
  Blades::State blades;
  Pieces::State pieces;
  Sleep::State sleep;
  Unravelling::State unravelling;
  FrequencyRatios ratios;
  typename StepLimit<Real>::FrameLimit limit;
  typename OwnSteps<Real>::State own_steps;
  typename Regions<Real>::State nodes;
  int mass_degree = 1;
  std::vector<Real> dashpots;  // strains of the dashpots of viscous tetrahedra (Regions::dashpots)
  Mat3X<double> acceleration;  // acceleration of implicit dynamics [m/s²]; empty: to be taken from the forces
  std::vector<Condition> pending;
  Transitions transitions;
  struct Term {
    std::string name, saved;
    static constexpr auto fields = std::tuple(&Term::name, &Term::saved);
  };
  std::vector<Term> terms;  // force terms, by their names
  WishMemory wishes;

  bool is_valid() const { return acceleration.allFinite(); }
  static constexpr auto fields = std::tuple(
      &Checkpoint::setup, &Checkpoint::state, &Checkpoint::history, &Checkpoint::held, &Checkpoint::tools,
      &Checkpoint::blades, &Checkpoint::pieces, &Checkpoint::sleep, &Checkpoint::unravelling,
      &Checkpoint::ratios, &Checkpoint::limit, &Checkpoint::own_steps, &Checkpoint::nodes,
      &Checkpoint::mass_degree, &Checkpoint::dashpots, &Checkpoint::acceleration, &Checkpoint::pending,
      &Checkpoint::transitions, &Checkpoint::terms, &Checkpoint::wishes);
};

// Writes and reads a checkpoint as a file. Reading throws InputError for a file that is damaged, cut off, of
// another version or precision. World::restore() throws for a checkpoint of another setup.
template <class Real>
void write_checkpoint(const std::filesystem::path& file, const Checkpoint<Real>& checkpoint);
template <class Real>
Checkpoint<Real> read_checkpoint(const std::filesystem::path& file);
// Writes and reads checkpoints as bytes in memory; `name` is for messages.
template <class Real>
std::string checkpoint_bytes(const Checkpoint<Real>& checkpoint);
template <class Real>
Checkpoint<Real> parse_checkpoint(const std::string& name, std::string_view bytes);
// A checkpoint of whichever precision the bytes are.
using AnyCheckpoint = std::variant<Checkpoint<float>, Checkpoint<double>>;
AnyCheckpoint parse_any_checkpoint(const std::string& name, std::string_view bytes);

// The last few checkpoints of a world, for an application that wants to go back.
template <class Real>
class CheckpointRing {
 public:
  struct Entry {
    Checkpoint<Real> checkpoint;
    std::size_t mark = 0;   // mark of the application: when it was made
    std::size_t bytes = 0;  // size, roughly
  };

  // Keeps at most `most` checkpoints in at most `most_bytes`, at least `apart` [s] of simulated time from
  // each other. The last checkpoint is kept in any case.
  CheckpointRing(std::size_t most, double apart, std::size_t most_bytes = SIZE_MAX)
      : most_(most), apart_(apart), most_bytes_(most_bytes) {}

  void keep(const World<Real>& world, std::size_t mark = 0);      // makes one if the last is old enough
  void keep_now(const World<Real>& world, std::size_t mark = 0);  // makes one unless the last is of this time
  // Removes the checkpoints after this time [s] and returns the latest one that is left. Null if none is
  // left.
  const Entry* latest(double time);
  // Restores the latest checkpoint that is at least `seconds` old, and removes those after it. False if there
  // is none.
  bool roll_back(World<Real>& world, double seconds);
  void clear() { entries_.clear(); }
  std::size_t size() const { return entries_.size(); }
  std::size_t bytes() const;

 private:
  std::size_t most_;
  double apart_;
  std::size_t most_bytes_;
  std::deque<Entry> entries_;
};

}  // namespace lobe
