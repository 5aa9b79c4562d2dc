// Assertions: what must hold whatever the input. One that fires is a fault of the library, never of a scene.
// lobe_assert() is for what costs next to nothing and stays on in every build; validate() (sim/validate.h)
// looks at all of a world, in debug builds and tests.
#pragma once

#include <stdexcept>
#include <string>

namespace lobe {

struct BrokenInvariant : std::logic_error {
  using std::logic_error::logic_error;
};

inline void lobe_assert(bool holds, const char* what) {
  if (!holds) throw BrokenInvariant(std::string("lobe: broken invariant: ") + what);
}

}  // namespace lobe
