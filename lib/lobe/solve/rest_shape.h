// The shape of a body without its loads, from its shape under them: the image of a patient shows an organ
// that gravity and pressure have deformed.
//
// With the given shape x fixed, the rest shape X is sought for which x is in equilibrium, f(X; x) = 0
// (S. Govindjee, P. A. Mihalic, Comput. Methods Appl. Mech. Engrg. 136, 1996). One iteration is
//   δ = K⁻¹ f(X; x),  X ← X − (∂X/∂x) δ
// with the tangent K of the body there: one step of Newton's method from x towards the equilibrium of the
// body that is at rest in X, in place of the whole solution of each iteration of M. Sellier (J. Fluids
// Struct. 27, 2011), and turned back with the body. Anderson's acceleration (H. F. Walker, P. Ni, SIAM J.
// Numer. Anal. 49, 2011) makes up for a factor of K that is some iterations old. In the end the loads are
// put on the shape that was found, from rest.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "lobe/solve/static_solver.h"

namespace lobe {

struct RestShapeOptions {
  double tolerance = 1e-5;    // bound of RestShape::distance [m]
  int most_iterations = 200;  // iterations, each with one solution of a linear system
  StaticOptions statics = {};
  const Mat3X<double>* start = nullptr;  // a guess at the rest shape, 3 × #vertices [m]; none: the given one
  std::function<void(int iteration, double distance)> progress = {};  // the distance is |δ| [m]
};

struct RestShape {
  bool converged = false;
  std::string reason;        // reason why not, in one line
  Mat3X<double> points;      // positions at rest, 3 × #vertices [m]
  Mat3X<double> u;           // displacement from there into equilibrium under the loads [m]
  double load_fraction = 0;  // share of the loads that were taken off
  // Distance of vertices of points + u from where they were given [m]; infinite where no equilibrium under
  // all loads was found.
  double distance = std::numeric_limits<double>::infinity();  // the largest
  double mean_distance = std::numeric_limits<double>::infinity();
  Index farthest = -1;     // vertex of the largest distance
  int iterations = 0;      // iterations for X
  int factorisations = 0;  // factors of tangents, those of the last solution among them
};

// `loaded` is the body in its given shape, with the loads that deform it. Prescribed vertices stay where they
// are given, less their prescribed displacement, and springs of partly held ones have no force at rest.
// Directions of fibres stay as they are given. If all loads cannot be taken off at once, they are in shares,
// as solve_static() puts them on. If it does not converge, `points` is unloaded by load_fraction only. Throws
// InputError as solve_static() does.
RestShape find_rest_shape(const Setup& loaded, const RestShapeOptions& options = {});

}  // namespace lobe
