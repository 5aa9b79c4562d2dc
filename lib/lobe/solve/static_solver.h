// Static equilibrium, the reference for everything that moves. It uses Newton's method with the exact tangent
// and a sparse factorisation with nested dissection. A line search never inverts a non-linear tetrahedron;
// from a state that is inverted it only accepts states that are less so. Load steps double after an
// equilibrium, and halve where none is found.
#pragma once

#include <functional>
#include <string>

#include "lobe/fem/elements.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct StaticOptions {
  double tolerance = 1e-10;          // bound of the residual, relative to the loads and reactions
  int most_iterations = 60;          // iterations of Newton's method per load step
  double smallest_load_step = 1e-4;  // smallest fraction of all loads and prescribed displacements in a step
  SparseFactorMaker factor = make_ldlt;
  // A guess at the solution, 3 × #vertices [m]. If none is given or it leads nowhere, all loads are tried at
  // once from u = 0, then in steps.
  const Mat3X<double>* start = nullptr;
  std::function<void(double load_fraction)> progress = {};
};

struct StaticResult {
  bool converged = false;
  std::string reason;        // reason why not, in one line, with the remedy
  double load_fraction = 0;  // fraction reached in equilibrium, 1 = all of it
  double residual = 0;       // relative residual at that fraction
  Mat3X<double> u;           // 3 × #vertices, displacement in equilibrium at load_fraction [m]
  // Reactions of what holds the body, forces on it where displacements are given, 3 × #vertices [N].
  Mat3X<double> reactions;
  double energy = 0;                 // elastic energy [J]
  double smallest_volume_ratio = 1;  // smallest det F over the non-linear region
  Index worst_tet = -1;              // tetrahedron where that is, or where the solver was stopped
  int iterations = 0;                // iterations of Newton's method in all
  int load_steps = 0;                // number of accepted load steps
  Index unknowns = 0;
  std::string factor;             // method and ordering
  long long factor_nonzeros = 0;  // fill of the factor
  // The share of the loads at which the equilibrium loses its stability, though no tetrahedron is near its
  // limit: the body buckles. 0: none was met.
  double buckling = 0;
  int damped = 0;  // iterations in which the tangent was not positive definite and was damped
};

// Finds the equilibrium under loads, pressures, gravity and prescribed displacements of the setup. Tools are
// ignored. Throws InputError if the setup is inconsistent, or if a piece of the body is free to move as a
// rigid body.
StaticResult solve_static(const Setup& setup, const StaticOptions& options = {});

}  // namespace lobe
