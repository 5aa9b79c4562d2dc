// Finds the parameters of materials and attachments from measurements in static equilibrium or in motion, and
// says how well they are known.
//
// Weighted least squares by the method of Levenberg and Marquardt. A trial beyond the range of a parameter is
// refused. In statics derivatives are exact ones of the discrete equilibrium (solve/static_sensitivity.h), so
// that a step costs one more factor for all parameters of a scene; frequencies cost two more for each. In
// motion they are central differences: a step costs two more runs of the scene for each parameter. Confidence
// intervals are those of the problem linearised at the solution, with Student's t (G. A. F. Seber, C. J.
// Wild, Nonlinear Regression, 1989, section 5).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lobe/fit/observe.h"
#include "lobe/fit/parameters.h"

namespace lobe {

// One loading of the body: its scene, and what was measured under it, all in equilibrium or all in motion.
struct FitCase {
  Setup setup;
  Observations observed;
  std::vector<Parameter> parameters;  // parameters; all cases have the same names in the same order
  double frame = 1.0 / 30;            // longest frame of a motion [s]
};

struct FitOptions {
  int most_iterations = 60;
  double tolerance = 1e-7;  // size of a step on the scales of the parameters, in fits to equilibria
  // In fits to motions. Their number of time steps changes with the moduli, so that the misfit has steps.
  double tolerance_in_motion = 3e-4;
  StaticOptions statics = {};
  std::function<void(int iteration, double misfit)> progress = {};  // progress; misfit as in FitResult
};

struct FittedParameter {
  std::string name;
  double start = 0, value = 0;
  double low = 0, high = 0;  // bounds of the confidence interval of 95 %; all that is possible if not told
  // Whether the measurements tell it apart from the others: a change by a factor e shows above the noise.
  bool is_identifiable = true;
};

struct FitResult {
  bool converged = false;
  std::string reason;  // reason why not, in one line
  std::vector<FittedParameter> parameters;
  std::vector<Eigen::VectorXd> values;  // what the solution says, case by case, as measured [m], [N], [Hz]
  // Root of the mean square of what is left: in standard deviations where these are told, else relative to
  // the root mean square of the measurements of that quantity.
  double misfit = 0, misfit_at_start = 0;
  int iterations = 0;
  std::vector<std::string> notes;  // lines on what the measurements do not tell
};

// Throws InputError if there are fewer measurements than parameters, if the scene as it is has no equilibrium
// or cannot be played, and as solve_static() and World do.
FitResult fit(const std::vector<FitCase>& cases, const FitOptions& options = {});

}  // namespace lobe
