// Pairs of bodies of different stiffness, size, mass and Poisson's ratio that are tied or touch, as World
// plays them: whether own steps let their energy grow.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe::bench {

enum class Joint {
  tied,     // a free bar, one end of which is of another material; it turns, swings and trembles
  touching  // a stiff cube that is dropped on a soft block, of another mesh
};

struct PairSetting {
  Joint joint = Joint::tied;
  double safety = 0.9, damping = 5;  // [-], γ [1/s]
  bool own_steps = true;
};

// E of the stiff part is 1 to 1,000 times 5 kPa, Poisson's ratios are 0.2 to 0.45, the density of the stiff
// part is ½ to 2 times the other. Every second pair has edge-smoothed tetrahedra.
Setup pair_of(int number, const PairSetting& setting);

struct PairFigures {
  bool blew_up = false;    // to 5 times the energy that it had, or the frame was given up
  double most_energy = 1;  // over that of the start, of bodies that touch: over what is lost until rest
  double drift = 0;        // of the mean energy from the first tenth to the last; undamped
  double share = 1;        // of the evaluations of one step for all
  int reruns = 0;          // frames
  bool gained() const { return most_energy > 1.05 || drift > 0.05; }
};

// With damping the pair is set swinging anew three times, after each quarter of the large steps.
PairFigures play_pair(int number, const PairSetting& setting, double large_steps);

}  // namespace lobe::bench
