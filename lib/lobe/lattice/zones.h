// Where reduced regions are full for a while: around what takes hold of them, and everywhere after it lets
// go.
#pragma once

#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

class FullZones {
 public:
  static constexpr double linger = 0.25;  // vertices stay full after they were touched [s]
  static constexpr double burst = 0.2;    // all are full after something let go [s]
  static constexpr double reach = 0.4;    // how far around what is touched they are full, in cells

  struct State {                 // part of a checkpoint
    std::vector<Index> touched;  // sorted
    std::vector<double> until;   // per vertex: when it was last to be full [s]; empty: none ever was
    double all_until = lowest;   // all vertices [s]
    bool is_valid() const {
      for (double t : until)
        if (std::isnan(t)) return false;
      return !std::isnan(all_until);
    }
    static constexpr auto fields = std::tuple(&State::touched, &State::until, &State::all_until);
  };

  // Vertices that something holds or presses now, sorted. `cell`: the edge of the lattice's cells [m].
  void look(const Elements& elements, double cell, double time, std::vector<Index> touched);
  bool is_full(Index v, double time) const {
    return time < state_.all_until - just_before ||
           (v < static_cast<Index>(state_.until.size()) && time < state_.until[std::size_t(v)] - just_before);
  }

  const State& state() const { return state_; }
  void set_state(const State& state) {
    state_ = state;
    around_is_known_ = false;
  }

 private:
  static constexpr double lowest = std::numeric_limits<double>::lowest();
  static constexpr double just_before = 1e-9;  // times are sums of frames [s]

  void find_around(const Elements& elements, double distance);

  State state_;
  std::vector<Index> around_;  // within reach of what is touched
  bool around_is_known_ = false;
};

}  // namespace lobe
