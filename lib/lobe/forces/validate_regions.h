// Checks that the regions of a body fit its tetrahedra, what is held and the masses that move.
#pragma once

#include "lobe/forces/regions.h"

namespace lobe {

// Throws BrokenInvariant, which names what does not fit.
template <class Real>
void validate_regions(const Regions<Real>& regions, const Model& model, const Motion<Real>& motion);

// Where the mass of the tetrahedra moves otherwise than at their corners [kg].
struct RegionMass {
  double inside = 0;  // mass of vertices that follow an interface
  double added =
      0;  // mass added to others: what an interface carries of `inside`, and what the regions have added
  double in_nodes = 0;  // mass in the nodes of a lattice
};
template <class Real>
RegionMass mass_of_regions(const Regions<Real>& regions, const Model& model);

}  // namespace lobe
