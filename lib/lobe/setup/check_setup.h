// Checks a setup before a World is built from it.
#pragma once

#include "lobe/setup/exclusions.h"

namespace lobe {

// Throws one InputError that names every fault: sizes and numbers out of range, flat or inverted tetrahedra,
// unstable moduli, values that are not finite, tools without a path or a radius. It also names options that
// are not available and options that exclude each other (exclusions.h), `wanted` ones included.
void check_setup(const Setup& setup, const Options& wanted = {});

}  // namespace lobe
