// Checks that all parts of a world fit together. It computes from the remaining tetrahedra, their corners and
// the held vertices what each part should have, and compares.
#pragma once

#include "lobe/assert.h"

namespace lobe {

template <class Real>
class World;

#ifdef NDEBUG
inline constexpr bool is_debug_build = false;
#else
inline constexpr bool is_debug_build = true;
#endif

// Throws BrokenInvariant, which names the first part that does not fit. O(#tetrahedra log #tetrahedra).
// In debug builds World calls it after each command, and after each frame that has cut.
template <class Real>
void validate(World<Real>& world);

}  // namespace lobe
