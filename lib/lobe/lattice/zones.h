// Full zones: vertices of reduced regions that move by themselves for a while (theory, section 18). Zones of
// linear regions are others (linearity/zones.h). Vertices are full
// - around those that tools hold, forces load or contact may press, and for `linger` afterwards;
// - everywhere, for `burst`, after a tool has let go, or has taken hold of a body that is not calm;
// - everywhere while the body moves quickly and no tool holds it, and for `quick` afterwards.
#pragma once

#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

class FullZones {
 public:
  static constexpr double linger = 0.25;  // time for which vertices stay full after they were touched [s]
  static constexpr double burst = 0.05;   // time for which all are full after a tool let go or took hold [s]
  // The body is calm while its displacement, √Σ m |u|², is below this share of the largest so far [-]. A
  // tool that takes hold of a calm body moves it by little at first: only its zone becomes full then.
  static constexpr double calm = 0.1;
  static constexpr double quick = 0.03;  // time for which all stay full after the body has moved quickly [s]
  // Radius of the zone around a held or loaded vertex, and around a pressed one [edges of a cell]. The
  // neighbours of the vertex always belong to the zone.
  static constexpr double reach = 0.4, reach_of_press = 1.2;
  // What a tool presses moves on while the tool slides. Vertices are embedded again at multiples of this
  // time, so that it happens seldom [s].
  static constexpr double every = 0.1;

  // A lattice whose frequencies are off by a share moves the body wrongly by share · τ |v|, where damping
  // ends what grows within τ. The body is quick where that is more than `most` of its largest displacement.
  static constexpr double share = 0.05, most = 0.015;
  static constexpr double longest = 0.04;  // τ where nothing damps [s]

  struct State {                       // part of a checkpoint
    std::vector<Index> held, touched;  // vertices, sorted; touched: held, loaded or pressed
    std::vector<double> until;         // time up to which a vertex was to be full [s]; empty: none ever was
    std::vector<double> asked_until;   // the same time, by ask()
    double all_until = lowest;         // time up to which all vertices were [s]
    double largest = 0;                // largest √Σ m |u|² so far [√kg m]
    bool is_valid() const {
      for (const std::vector<double>* values : {&until, &asked_until})
        for (double t : *values)
          if (std::isnan(t)) return false;
      return !std::isnan(all_until) && largest >= 0;
    }
    static constexpr auto fields = std::tuple(&State::held, &State::touched, &State::until,
                                              &State::asked_until, &State::all_until, &State::largest);
  };

  struct Sight {                 // what is seen at a moment
    std::vector<Index> held;     // vertices that tools hold, sorted
    std::vector<Index> loaded;   // vertices on which forces and springs act, sorted
    std::vector<Index> pressed;  // vertices on which contact may act, sorted
    double displacement = 0;     // √Σ m |u|² [√kg m]
    double speed = 0;            // √Σ m |v|² [√kg m/s]
    double damping = 0;          // γ [1/s]
  };
  // `cell`: the edge of the lattice's cells [m].
  void look(const Elements& elements, double cell, double time, const Sight& sight);
  // Asks for vertices to be full until a time, rounded up to a multiple of `every` [s]; or until all were,
  // since what comes after that is another motion.
  void ask(const std::vector<Index>& vertices, Index vertex_count, double until);
  std::vector<Index> take_due(double time);  // asked ones that need not be full any more
  bool is_full(Index v, double time) const {
    const auto is_before = [&](const std::vector<double>& until) {
      return v < static_cast<Index>(until.size()) && time < until[std::size_t(v)] - just_before;
    };
    return time < state_.all_until - just_before || is_before(state_.until) || is_before(state_.asked_until);
  }

  // Call it after an edit of the mesh: neighbours may be others.
  void forget_around() { around_is_known_ = false; }

  const State& state() const { return state_; }
  void set_state(const State& state) {
    state_ = state;
    around_is_known_ = false;
  }

 private:
  static constexpr double lowest = std::numeric_limits<double>::lowest();
  static constexpr double just_before = 1e-9;  // times are sums of frames [s]

  void find_around(const Elements& elements, double cell);

  State state_;
  std::vector<Index> pressed_;  // pressed vertices when around_ was found
  std::vector<Index> beside_;   // touched vertices and their neighbours
  std::vector<Index> around_;   // vertices within reach of touched ones
  bool around_is_known_ = false;
};

}  // namespace lobe
