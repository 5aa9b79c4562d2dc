// What a World asks of a setup.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe {

// Throws one InputError that names every kind of fault: sizes and numbers out of range, flat or inverted
// tetrahedra, moduli without stability, values that are not finite, tools without a path or a radius, what is
// not available yet.
void check_setup(const Setup& setup);

}  // namespace lobe
