#include "lobe/solve/newton.h"

#include <algorithm>
#include <cmath>

namespace lobe {
namespace {

const char* line_search(const NewtonProblem& problem, const Mat3X<double>& direction, double slope,
                        NewtonPoint& point) {
  const char* reason = "";
  const double least_ratio = std::min(0.0, point.smallest_volume_ratio);
  for (double length = 1; length > 1e-3; length /= 2) {
    NewtonPoint trial = problem.at(point.u + length * direction);
    point.smallest_tet = trial.smallest_tet;
    reason = "every step inverts it";
    if (!(trial.smallest_volume_ratio > least_ratio)) continue;
    reason = "no step lowers the potential";
    const bool falls = trial.potential <= point.potential + 1e-4 * length * slope;
    if (!falls && !(trial.residual.norm() < 0.9 * point.residual.norm())) continue;
    point = std::move(trial);
    return nullptr;
  }
  return reason;
}

}  // namespace

NewtonResult minimise(NewtonProblem& problem, NewtonPoint& point, double tolerance, int most_iterations) {
  NewtonResult result;
  Mat3X<double> direction;
  for (; result.iterations < most_iterations; ++result.iterations) {
    if (!std::isfinite(point.scale)) {
      result.reason = "its forces are too large for double precision";
      return result;
    }
    result.converged = point.residual.norm() <= tolerance * point.scale;
    if (result.converged) return result;
    if (!problem.direction(point, direction)) {
      result.reason = "the tangent is singular there (a mechanism, or a collapsed tetrahedron)";
      return result;
    }
    const double slope = -direction.cwiseProduct(point.residual).sum();
    if (const char* reason = line_search(problem, direction, slope, point)) {
      result.reason = reason;
      return result;
    }
  }
  result.reason = "Newton's method did not converge";
  return result;
}

}  // namespace lobe
