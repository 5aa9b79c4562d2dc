// Assertions state what must hold for every input. If one fires, the library has a fault, never the scene.
// lobe_assert() costs next to nothing and is on in every build. validate() (sim/validate.h) checks all of a
// world, in debug builds and tests.
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
