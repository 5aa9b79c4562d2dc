// Natural modes of a body at rest: K φ = ω² M φ with lobe's tangent at u = 0 and its lumped masses.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe::validation {

struct Mode {
  double omega = 0;     // [rad/s]
  Mat3X<double> shape;  // 3 × #vertices, largest displacement 1
  double overlap = 0;   // with the guess, |φᵀ M g| / (‖φ‖ ‖g‖)
};

// The mode that Rayleigh quotient iteration finds from a guess; prescribed vertices do not move. Throws
// std::runtime_error if it does not converge.
Mode mode_like(const Setup& setup, const Mat3X<double>& guess);

}  // namespace lobe::validation
