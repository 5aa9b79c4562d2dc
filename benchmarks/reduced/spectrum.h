// The lowest frequencies at rest of a body some of whose vertices are embedded: what an error of stiffness or
// of inertia does to the swing after a release, without any gesture.
#pragma once

#include "benchmarks/reduced/cell.h"
#include "benchmarks/reduced/membership.h"

namespace lobe::reduced {

std::vector<double> lowest_frequencies(const Elements& elements, const Lattice& lattice,
                                       const Membership& membership, Stiffening stiffening,
                                       int count);  // ω [rad/s], rising

}  // namespace lobe::reduced
