// Checks the invariant of cutting: after any edit, the state equals that of a model built from scratch from
// the cut mesh.
#pragma once

#include "lobe/sim/world.h"

namespace lobe {

struct RebuildDifference {  // relative, largest over vertices
  double mass = 0;
  double force = 0;           // internal and external forces at the same displacements
  double interior = 0;        // displacements of a pre-computed region in equilibrium
  double frequency = 0;       // vertex estimates of ω_max, from which the time step follows
  bool same_boundary = true;  // whether boundaries agree; not looked at where a blade has cut between grains
  bool same_regions = true;
  double largest() const;  // infinite if boundary or regions differ
};

// Builds a new world from world.current_setup() and compares. O(building a world).
template <class Real>
RebuildDifference compare_with_rebuilt(World<Real>& world);

}  // namespace lobe
