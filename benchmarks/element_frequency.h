// The lowest natural frequency of a body at rest, by its elements and by 10-node tetrahedra on the same mesh.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe::bench {

// Of K φ = ω² M φ with the tangent at u = 0 and lumped masses, as the body has them in motion [rad/s].
double lowest_frequency(const Setup& setup);

// The same of 10-node tetrahedra with their consistent masses. Loads and what the setup moves do not matter;
// what it holds does.
double lowest_quadratic_frequency(const Setup& setup);

}  // namespace lobe::bench
