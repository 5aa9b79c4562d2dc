// The highest frequency of a model, which limits the explicit time step to 2/ω_max.
#pragma once

#include <functional>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct HighestFrequency {
  double omega = 0;       // [rad/s], on the safe side: the last Ritz value plus its residual
  int evaluations = 0;    // evaluations of all forces
  bool converged = true;  // the residual is below the tolerance
};

struct LanczosSettings {
  double tolerance = 0.005;  // residual that is left, as a share of ω
  int most = 48;             // evaluations of all forces
};

// Finds ω_max by Lanczos iterations of K C on vectors of forces, in the inner product of C. Products with K
// are differences of forces, which vanish at u = 0. If C is the inverse of lumped masses, they start from
// forces that are large where the vertex estimates are high, because the highest mode is local. The forces
// are nowhere zero, because that mode may be elsewhere.
template <class Real>
HighestFrequency highest_frequency(
    const std::vector<double>& inverse_mass,     // [1/kg], 0 where held
    const std::function<double(Index)>& square,  // ω_v² of a vertex [1/s²]
    double small,                                // displacements at which forces are linear [m]
    const std::function<void(const Mat3X<Real>&, Mat3X<Real>&)>& add_forces,  // (u, f), both 3 × #vertices
    const LanczosSettings& settings = {},
    // C of selective mass scaling, in place of the inverse masses: turns forces into accelerations.
    const std::function<void(Mat3X<Real>&)>& scale = {});

}  // namespace lobe
