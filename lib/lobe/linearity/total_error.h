// How far the tetrahedra of a mesh are from the truth of their own body, for what will be done to it: static
// solutions with the scene's own regions, against 10-node tetrahedra on the same mesh, all non-linear. The
// error has two parts: that of the element, where the same body is held; and that of what is held, since a
// selector takes other vertices on every mesh.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lobe/mesh/refine.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/setup.h"

namespace lobe {

// The error of one solution relative to another.
struct ErrorShare {
  double l2 = 0;       // error of the displacement over the body in L2, by mass
  double largest = 0;  // excess of the largest displacement
  double force = 0;    // excess of the force on what the gesture moves; 0 for the weight
};

struct TotalError {
  std::string name;     // name of the gesture
  std::string trouble;  // reason why there is no figure; empty if there is one
  double largest = 0;   // largest displacement [m] of the mesh's solution
  double force = 0;     // force on what the gesture moves [N]; 0 for the weight
  ErrorShare element;   // error with the same body held
  // Error of what is held: of the truth with the body held that the mesh holds, to that with the nodes that
  // the mesh refined once selects. And the whole error, to the latter. None if that is not known.
  std::optional<ErrorShare> held, total;
  std::string held_trouble;  // reason why held and total are not known, if asked for
};

struct TotalErrorOptions {
  SparseFactorMaker factor = {};  // factor; if none is given, a Cholesky factor by dense blocks
  std::function<void(double fraction)> progress = {};
  // The setup that the scene gives on the refinement of the mesh. If it is given, what is held is judged.
  std::function<Setup(const RefinedMesh& refined)> on_refined = {};
};

// For each of static_loads() (gestures.h). Corotated regions, which have no static solution, count as
// non-linear. Throws InputError if the setup is inconsistent or the body is not held.
std::vector<TotalError> total_errors(const Setup& setup, const TotalErrorOptions& options = {});

// A table for people.
std::string total_error_table(const std::vector<TotalError>& errors);

}  // namespace lobe
