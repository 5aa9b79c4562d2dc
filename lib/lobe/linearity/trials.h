// Trials: the equilibria of gestures with all of the body non-linear. Regions are compared with them.
#pragma once

#include <functional>

#include "lobe/linearity/gestures.h"
#include "lobe/solve/static_solver.h"

namespace lobe {

struct Trial {
  Setup setup;      // setup at the gesture's end, or as far as there is an equilibrium
  Mat3X<double> u;  // all non-linear, in equilibrium: 3 × #vertices [m]
  std::size_t gesture = 0;
  double norm = 0;  // √∫|u|² [m^2.5]
};

// The trials of all gestures that have an equilibrium for a large enough part of their motion. `followed` is
// called for every gesture.
std::vector<Trial> solve_trials(
    const Setup& setup, const std::vector<Gesture>& gestures,
    const std::function<void(std::size_t gesture, const StaticResult& found)>& followed = {});

// The relative L2 error of the equilibrium with these regions; 1 if none is found.
double static_error(const std::vector<RegionModel>& region_of, const Trial& trial);

}  // namespace lobe
