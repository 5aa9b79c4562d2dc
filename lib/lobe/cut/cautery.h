// Cautery: burns away the tetrahedra that a moving sphere touches. [PDA] section 3.2.
#pragma once

#include <vector>

#include "lobe/mesh/topology.h"

namespace lobe {

// A sphere that moves in a straight line.
struct Sweep {
  Vec3d from, to;     // [m]
  double radius = 0;  // [m], > 0
};

// Alive tetrahedra of the deformed body within reach of the sweep, in ascending order. The sweep is sampled every
// quarter of the radius (between samples the reach is short of the radius by less than 1 %), in at most 10,000 places.
// O(#tets), some nanoseconds each.
std::vector<Index> touched_tets(const Topology& topology,
                                const Mat3X<double>& x,  // 3 × #vertices, current positions [m]
                                const Sweep& sweep);

}  // namespace lobe
