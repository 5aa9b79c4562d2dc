// How far the tetrahedra of a mesh are from the truth of their own body, for what will be done to it: static
// solutions with the scene's own regions, against 10-node tetrahedra on the same mesh, all non-linear, with
// the same body held.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct TotalError {
  std::string name;       // of the gesture
  std::string trouble;    // why there is no figure; empty if there is one
  double l2 = 0;          // relative L2 error of the displacement over the body, by mass
  double largest = 0;     // largest displacement [m] of the mesh's solution
  double of_largest = 0;  // by how much that is larger than the truth's, relative
  double force = 0;       // on what the gesture moves [N]; 0 if it is the weight
  double of_force = 0;    // by how much that is larger than the truth's, relative
};

struct TotalErrorOptions {
  SparseFactorMaker factor = make_ldlt;
  std::function<void(double fraction)> progress = {};
};

// For each of static_loads() (gestures.h). Corotated regions, which have no static solution, count as
// non-linear. Throws InputError if the setup is inconsistent or the body is not held.
std::vector<TotalError> total_errors(const Setup& setup, const TotalErrorOptions& options = {});

// A table for people.
std::string total_error_table(const std::vector<TotalError>& errors);

}  // namespace lobe
