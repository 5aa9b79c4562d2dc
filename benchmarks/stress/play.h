// A plan played, and judged by what was measured on the way.
#pragma once

#include "benchmarks/stress/plan.h"

namespace lobe::stress {

struct Verdict {
  bool passed = false;
  std::string why;  // it failed; or what it reported
  bool in_double = false;
  double smallest_ratio = 1, largest_ratio = 1;  // of det F over the non-linear tetrahedra, at frame ends
  double last_ratio = 1;                         // the smallest at the end
  double energy_start = 0;                   // kinetic, elastic and of loads [J]; kinetic half a step before
  double energy_early = 0, energy_late = 0;  // the largest of the first and of the second half
  double momentum_drift = 0;                 // of a body that nothing holds or loads, relative to Σ m|v|
  double cut_error = 0;  // largest difference of the cut world to one built afresh, in double precision
  double farthest = 0;   // at the end, displacement relative to the longest side of the box
  long steps = 0;
  int reruns = 0;
  double unravelling = 0;  // for which tetrahedra were linear on the way out of a tangle [s]
  double smallest_step = 0, largest_step = 0;  // [s]
  std::string limited_by;                      // where the shortest step came from
  double seconds = 0;                          // of processor time
};

template <class Real>
Verdict play(const Plan& plan);

}  // namespace lobe::stress
