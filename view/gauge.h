// What is found of a running simulation some times a second, between two frames: its energies, and a field on
// its surface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/sim/world.h"

namespace lobe::view {

struct Measured {
  std::uint64_t number = 0;         // counted from 1
  double time = 0;                  // [s]
  double elastic = 0, kinetic = 0;  // [J]
  std::string scalar = "none";
  std::uint64_t revision = 0;  // of the surface
  std::vector<float> values;   // per vertex of it, of `scalar`
};

// O(#tetrahedra), and less than that by far for the field alone.
template <class Real>
void measure(World<Real>& world, const std::string& scalar, Measured& measured);

}  // namespace lobe::view
