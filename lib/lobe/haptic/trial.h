// Finds by trial how long the frames of a session with a haptic hand should be.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe {

struct HapticTrial {
  bool is_direct = false;   // frames of 1 ms fit, and no region is reduced: the simulation answers the hand
  double p50 = 0, p99 = 0;  // quantiles of the clock time of a frame of 1 ms with its look [s]
  int frames = 0;           // number of frames tried
};

inline constexpr double direct_frame = 1e-3;  // [s]
inline constexpr double direct_share = 0.7;   // share of a direct frame that p99 may take

// Pulls at the surface for `frames` frames of 1 ms, in a world of its own, and looks after each where a probe
// there would touch, as a hand with a probe does. Throws InputError for a setup that
// no world can be built from.
template <class Real>
HapticTrial try_direct(const Setup& setup, int threads = 1, int frames = 400);

}  // namespace lobe
