// At which levels the patches of a body step in a frame, and in how many steps (theory, section 7, own
// steps).
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "lobe/time/levels.h"

namespace lobe {

// Patches as parts of a body.
struct PatchGraph {
  struct Patch {
    double cost = 0;       // of an evaluation, as compared to others; 0: it is empty
    Level pace = 0;        // by which it was laid out
    bool is_tied = false;  // steps with all others that are: their forces come from no energy of their own
  };
  std::vector<Patch> patches;
  std::vector<std::vector<Index>> neighbours;  // per patch: those that share a vertex
};

using LevelRatios = std::array<double, std::size_t(highest_level) + 1>;

// What is known of the patches in a frame.
struct PatchLimits {
  std::vector<double> squares;        // per patch: the highest ω_v² of its vertices [1/s²]
  std::vector<std::uint8_t> is_fast;  // per patch: steps at level 0
  LevelRatios ratios;  // per level: its highest frequency over that of its vertices, at least 1
  double longest = 0;  // step where all step together [s]
  double safety = 1;   // share of the stable step that it may be
};

struct OwnPace {
  int steps = 1;              // of level 0 in the frame, a multiple of 2^top
  std::vector<Level> levels;  // per patch; empty: all 0
  double share = 1;           // of the evaluations that one step for all takes in as many steps
  Level top() const { return levels.empty() ? Level(0) : *std::max_element(levels.begin(), levels.end()); }
};

// A patch of another pace than was measured has this much higher a frequency than its vertices tell.
inline constexpr double unmeasured_ratio = 1.1;
// What each step costs in any case, as a share of an evaluation of all patches.
inline constexpr double cost_of_step = 0.1;
// Levels are begun with where they cost at most this share of one step for all: patches at held vertices
// alone, which may step more seldom in any body, are not worth it.
inline constexpr double worth_it = 0.8;
// How much more than others may cost what changes neither levels nor the length of steps. At each change
// swings of high frequency get another amplitude, on average a higher one: central differences conserve a
// discrete energy for steps of one length.
inline constexpr double worth_a_change = 1.15;
// Where there are levels, no step is chosen to be longer than this share of the stable one, and none is kept
// that is longer than the second one. Where large steps begin, all levels kick at once: a vertex where levels
// meet feels more than each of them alone. Of 500 bodies with a damping of 5/s one blew up at 0.84 of the
// stable step and one at 0.82, none at 0.80.
inline constexpr double safety_of_levels = 0.8, safety_to_keep = 1.0225 * safety_of_levels;

// Whether patches of these levels are stable with short steps of dt [s], up to `safety`.
bool are_stable(const PatchGraph& graph, const PatchLimits& limits, const std::vector<Level>& levels,
                double dt, double safety);

// The levels, none above `top`, at which patches may step if short steps take dt [s].
std::vector<Level> levels_of_patches(const PatchGraph& graph, const PatchLimits& limits, double dt,
                                     Level top);

// The pace of a frame before, if any, and how many of its steps make up this frame; 0: no whole number.
struct PresentPace {
  std::vector<Level> levels;  // empty: all stepped together
  int steps = 0;
};

// The cheapest pace for a frame that takes `fewest` steps where all step together. Shorter steps are tried as
// well, as they may let a large part take four of them at once in place of two. The present pace is kept
// where it is stable and costs little more than others, and less than one step for all.
OwnPace choose_pace(const PatchGraph& graph, const PatchLimits& limits, int fewest,
                    const PresentPace& present);
// The present pace, if it is stable and costs less than one step for all.
std::optional<OwnPace> keep_pace(const PatchGraph& graph, const PatchLimits& limits, int fewest,
                                 const PresentPace& present);

}  // namespace lobe
