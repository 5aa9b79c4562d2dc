// The rest data of a body in motion, with revision numbers that say what has changed.
#pragma once

#include <algorithm>
#include <cstdint>

#include "lobe/fem/elements.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

// Each number only grows. A part stores the numbers for which it was computed. It is out of date as soon as
// one of them differs.
struct Revisions {
  std::uint64_t structure = 0;  // the set of tetrahedra, the model of each, and which of them are condensed
  std::uint64_t inertia = 0;    // masses, and which components move by themselves
  std::uint64_t displacements = 0;  // by steps, or set from outside
  std::uint64_t velocities = 0;
  std::uint64_t jumps = 0;     // vertices that moved otherwise than by steps
  std::uint64_t replaced = 0;  // a state that did not come from a step
  std::uint64_t restored = 0;  // returns to a state before some edits
  std::uint64_t terms = 0;     // the force terms, what they act on, which tools they see
  bool operator==(const Revisions&) const = default;
};

// Returns numbers that neither of the two has had.
inline Revisions newer_than_both(const Revisions& a, const Revisions& b) {
  return {std::max(a.structure, b.structure) + 1,
          std::max(a.inertia, b.inertia) + 1,
          std::max(a.displacements, b.displacements) + 1,
          std::max(a.velocities, b.velocities) + 1,
          std::max(a.jumps, b.jumps) + 1,
          std::max(a.replaced, b.replaced) + 1,
          std::max(a.restored, b.restored) + 1,
          std::max(a.terms, b.terms) + 1};
}

struct Model {
  Elements elements;
  HeldVertices held;
  Revisions revisions;
};

}  // namespace lobe
