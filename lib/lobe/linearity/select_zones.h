// Selects the linear zones: the cheapest step whose predicted error stays below the tolerance.
#pragma once

#include "lobe/linearity/step_cost.h"
#include "lobe/linearity/zones.h"

namespace lobe {

// The error that linear zones cause in one gesture, to first order.
struct TrialError {
  Eigen::MatrixXd
      contributions;  // mean displacement errors of all zones, for each linear zone [m]: 3 × #zones by #zones
  double norm = 0;    // √∫|u|² of the exact displacement [m^2.5]
  double scale = 1;   // factor on the prediction, as measurements have told

  // Relative to the displacement, in L2.
  double relative(const Zones& zones, const Eigen::VectorXd& error) const;  // 3 × #zones [m]
  double of(const Zones& zones, const std::vector<char>& linear) const;     // predicted error, scale included
};

// Returns one flag per zone. First, zones are added that add least to the error of the worst gesture. Then
// zones at the border change sides while that makes the step cheaper. With `condensed`, linear zones cost
// what their interface costs.
std::vector<char> select_zones(const Elements& elements, const Zones& zones,
                               const std::vector<TrialError>& trials, double tolerance, const StepCost& cost,
                               bool condensed);

}  // namespace lobe
