// The shape of a body without its loads, from its shape under them: the image of a patient shows an organ
// that gravity and pressure have deformed.
//
// The rest shape X satisfies X + u(X) = x, with the given shape x and the static displacement u(X) of a body
// that is at rest in X. X ← x − u(X) is repeated (M. Sellier, An iterative method for the inverse
// elasto-static problem, J. Fluids Struct. 27, 2011), with Anderson's acceleration (H. F. Walker, P. Ni, SIAM
// J. Numer. Anal. 49, 2011).
#pragma once

#include <functional>
#include <string>

#include "lobe/solve/static_solver.h"

namespace lobe {

struct RestShapeOptions {
  double tolerance = 1e-5;   // bound of the distance below [m]
  int most_iterations = 60;  // iterations, each with a static solution
  StaticOptions statics = {};
  std::function<void(int iteration, double distance)> progress = {};
};

struct RestShape {
  bool converged = false;
  std::string reason;    // reason why not, in one line
  Mat3X<double> points;  // positions at rest, 3 × #vertices [m]
  Mat3X<double> u;       // displacement from there into equilibrium under the loads [m]
  double distance = 0;   // largest distance of a vertex of points + u from where it was given [m]
  int iterations = 0;
};

// `loaded` is the body in its given shape, with the loads that deform it. Prescribed vertices stay where they
// are given, less their prescribed displacement. Directions of fibres are those of the given shape. Throws
// InputError as solve_static() does. If it does not converge, the best shape so far is returned.
RestShape find_rest_shape(const Setup& loaded, const RestShapeOptions& options = {});

}  // namespace lobe
