// Proposes regions for declared gestures: those with the cheapest step whose displacement error stays below a
// tolerance, measured against the non-linear body (theory, section 15).
#pragma once

#include <functional>
#include <optional>

#include "lobe/linearity/gestures.h"
#include "lobe/linearity/step_cost.h"

namespace lobe {

struct ProposalOptions {
  double tolerance = 0.02;            // bound of the relative L2 error of the displacement
  bool condense = true;               // linear regions may be precomputed
  bool tensor_mass = true;            // linear regions may be tensor-mass
  Index zones = 0;                    // 0: usual_zone_count()
  bool in_double = false;             // precision of the run in which its step is timed
  std::optional<StepCost> cost = {};  // used in place of measuring: the same regions at any time and anywhere
  std::function<void(double fraction)> progress = {};
};

struct GestureOutcome {
  std::string name;
  double reached = 1;                  // share of the gesture at which the body was still in equilibrium
  double predicted = 0, measured = 0;  // relative L2 error
};

struct Proposal {
  std::vector<RegionModel> region_of;                  // model of each tetrahedron
  double linear_share = 0;                             // share of the volume
  double predicted_speedup = 1, measured_speedup = 1;  // of a step, compared with all non-linear
  std::vector<GestureOutcome> gestures;
  std::vector<std::string> notes;  // lines that say what could not be had, and why
};

// The regions of the setup are ignored. Without gestures it takes usual_gestures(). Nothing is linear if that
// would not pay, if the tolerance cannot be met, or if the body floats; the notes say so. Takes a static
// solution per gesture and try. Deterministic, except for the choice by measured cost.
Proposal propose_regions(const Setup& setup, std::vector<Gesture> gestures, const ProposalOptions& options);

// Proposes regions that are corrected while they run (watch.h). Pre-computed regions may then be wrong by
// three times the tolerance (up to 7 %), because they will be relinearised or expanded. If no pre-computed
// region pays, tensor-mass regions are proposed as above.
Proposal propose_regions_to_correct(const Setup& setup, const std::vector<Gesture>& gestures,
                                    ProposalOptions options);

}  // namespace lobe
