// Which material, held part or model of a region moves the answer most: how the static displacement, and the
// force on what a gesture moves, change with each of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lobe/numerics/sparse_factor.h"
#include "lobe/scene/resolve.h"

namespace lobe {

struct Effect {
  std::string of;           // "liver.young_modulus + 10 %"
  double displacement = 0;  // L2 norm over the body by mass of its change, relative
  double largest = 0;       // relative change of the largest displacement
  double force = 0;         // relative change of the force on what the gesture moves; 0 for the weight
  std::string trouble;      // reason why there is no figure; empty if there is one
};

struct Sensitivity {
  std::string gesture;
  std::string trouble;          // reason why there is no figure; empty if there is one
  double largest = 0;           // largest displacement [m]
  double force = 0;             // force on what the gesture moves [N]; 0 for the weight
  std::vector<Effect> effects;  // the largest first: by force if there is one, else by displacement
  // Per tetrahedron: by how much the answer (the force; under the weight, the L2 norm of the displacement)
  // changes, relative, if the energy of that tetrahedron grows by a relative amount, per share of the body's
  // volume. 1 everywhere: all of the body counts alike. The energy of a smoothing domain or of a nodal
  // pressure is that of its tetrahedra, by volume.
  std::vector<double> of_tets;
};

struct SensitivityOptions {
  SparseFactorMaker factor = make_ldlt;
  std::function<void(double fraction)> progress = {};
};

// For each of static_loads() (linearity/gestures.h):
// - parameters of materials (parameters.h) that may not be zero, by derivatives, for a change by 10 %; of
//   Poisson's ratio by 10 % of ½ − ν,
// - each entry of "boundary" that fixes vertices: held by nine tenths (body/hold_springs.h),
// - each linear model of a region: as non-linear, and the non-linear one as linear.
// Throws InputError if the setup is inconsistent or the body is not held.
std::vector<Sensitivity> sensitivities(const Scene& scene, const Resolved& resolved,
                                       const SensitivityOptions& options = {});

// A table for people.
std::string sensitivity_table(const std::vector<Sensitivity>& found);

}  // namespace lobe
