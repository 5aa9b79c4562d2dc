// Checks a setup before a World is built from it.
#pragma once

#include "lobe/setup/exclusions.h"

namespace lobe {

// Throws one InputError that names every kind of fault: sizes and numbers out of range, flat or inverted
// tetrahedra, moduli without stability, values that are not finite, tools without a path or a radius, what is
// not available yet, what excludes each other (exclusions.h), also what else is `wanted`.
void check_setup(const Setup& setup, const Options& wanted = {});

}  // namespace lobe
