// Sleep: patches at rest are held where they are until something pulls at their vertices (theory, section 8).
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "lobe/types.h"

namespace lobe {

template <class Real>
struct Dynamics;

class Sleep {
 public:
  static constexpr double still_time = 0.1;  // a vertex that is still for so long may fall asleep [s]
  // Part of a checkpoint; empty if nothing may sleep.
  struct State {
    std::vector<std::uint8_t> asleep;  // flag of each vertex
    std::vector<double> still_since;   // time since when each vertex is still [s]
    std::vector<double> squares;  // ω_v² of each vertex or a bound of it, from the last step limit [1/s²]

    bool is_valid() const {
      return std::all_of(asleep.begin(), asleep.end(), [](auto one) { return one <= 1; }) &&
             std::all_of(still_since.begin(), still_since.end(), [](double t) { return std::isfinite(t); }) &&
             std::all_of(squares.begin(), squares.end(), [](double square) { return square >= 0; });
    }
    static constexpr auto fields = std::tuple(&State::asleep, &State::still_since, &State::squares);
  };

  Sleep() = default;
  // `tolerance`: by how much sleep may change displacements [m]; 0: nothing sleeps. `move`: how far a
  // sleeping vertex may be from its equilibrium while its neighbours are held [m].
  Sleep(double tolerance, double move)
      : tolerance_(tolerance), move_(move), slowest_drift_(tolerance / still_time) {}

  double tolerance() const { return tolerance_; }
  bool is_on() const { return move_ > 0; }
  bool any() const { return count_ > 0; }
  Index count() const { return count_; }
  bool is_asleep(Index v) const { return any() && state_.asleep[v] != 0; }
  std::uint64_t revision() const { return revision_; }  // grows when a vertex falls asleep or wakes

  void extend(Index vertices, double time) {  // new ones are awake
    if (!is_on()) return;
    state_.asleep.resize(std::size_t(vertices), 0);
    state_.still_since.resize(std::size_t(vertices), time);
    state_.squares.resize(std::size_t(vertices), 0);
  }
  // Call it when the step limit has been found. `square`: ω_v² of a vertex, or a bound of it [1/s²].
  template <class Square>
  void see_frequencies(const Square& square) {
    for (std::size_t v = 0; v < state_.squares.size(); ++v) state_.squares[v] = square(Index(v));
  }
  // Wakes these vertices and all patches around them.
  template <class Real>
  void wake(const std::vector<Index>& vertices, Dynamics<Real>& body);
  void wake_all(double time);

  const State& state() const { return state_; }
  void set_state(const State& state);

  // Call it at the start of a frame. Vertices that have been still may fall asleep in the next step.
  void begin_frame() { frame_begins_ = true; }
  // Call it between the forces of a step and its motion, because the sums that patches keep belong to the
  // present displacements.
  template <class Real>
  void update(Dynamics<Real>& body);
  // Call it before an evaluation of forces. Returns the vertices whose forces may change, while the others
  // keep theirs; null: all vertices.
  template <class Real>
  const std::vector<Index>* begin_forces(Dynamics<Real>& body);

 private:
  struct BorderVertex {  // a sleeping vertex next to one that is awake
    Index vertex = 0;
    double most = 0;  // force above which it wakes [N]
  };

  template <class Real>
  void fall_asleep(Dynamics<Real>& body);
  template <class Real>
  bool is_still(Index vertex, const Dynamics<Real>& body) const;
  template <class Real>
  void wake_pulled(Dynamics<Real>& body);
  template <class Real>
  bool forces_are_kept(const Dynamics<Real>& body) const;
  template <class Real>
  void keep_forces(Dynamics<Real>& body);
  template <class Real>
  std::vector<std::uint8_t> find_evaluated(Dynamics<Real>& body);

  double tolerance_ = 0;      // [m]
  double move_ = 0;           // [m]
  double slowest_drift_ = 0;  // [m/s]
  State state_;
  Index count_ = 0;
  std::uint64_t revision_ = 0;
  bool frame_begins_ = false;

  // Data that a step reads while a vertex sleeps, and the revisions for which they were found:
  std::vector<Index> evaluated_;
  std::vector<BorderVertex> border_;
  struct FoundAt {
    std::uint64_t structure = 0, replaced = 0, sums = 0, sleepers = 0;
    bool operator==(const FoundAt&) const = default;
  } found_at_{.structure = ~std::uint64_t(0)};
  template <class Real>
  FoundAt now(const Dynamics<Real>& body) const;
};

}  // namespace lobe
