// Whether all that a world keeps fits together. It is found again from the tetrahedra that are left, their
// corners and what holds them, and compared with what the parts have kept up to date from edit to edit.
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
