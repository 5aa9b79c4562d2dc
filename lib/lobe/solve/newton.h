// Newton's method for minima of a potential over the unknown displacement components: the core of statics and
// of implicit time steps.
#pragma once

#include "lobe/types.h"

namespace lobe {

struct NewtonPoint {
  Mat3X<double> u;         // 3 × #vertices [m]
  double potential = 0;    // [J]
  Mat3X<double> residual;  // minus its gradient, 3 × #vertices, zero where displacements are given [N]
  double scale = 0;        // scale of the forces of which the residual is the sum [N]
  double smallest_volume_ratio = 1;  // least det F over the non-linear region
  Index smallest_tet = -1;
};

class NewtonProblem {
 public:
  virtual ~NewtonProblem() = default;
  virtual NewtonPoint at(const Mat3X<double>& u) const = 0;
  // Finds a direction of descent, which is zero where displacements are given. False if there is none.
  virtual bool direction(const NewtonPoint& at, Mat3X<double>& direction) = 0;
};

struct NewtonResult {
  bool converged = false;
  const char* reason = "";  // why not
  int iterations = 0;
};

// Goes from `point` to a minimum. Steps are halved until two conditions hold: no non-linear tetrahedron is
// inverted (or, if some were at the start, none is more inverted), and the potential falls. Where rounding
// hides the potential, the residual must fall. On failure the point is the last one that was accepted, but
// its smallest_tet is that of the last one that was tried.
NewtonResult minimise(NewtonProblem& problem, NewtonPoint& point, double tolerance, int most_iterations);

}  // namespace lobe
