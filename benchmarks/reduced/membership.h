// Which vertices move by themselves and which are embedded in the lattice.
#pragma once

#include "benchmarks/reduced/lattice.h"

namespace lobe::reduced {

enum class Motion : std::uint8_t { held, own, embedded };

struct Membership {
  std::vector<Motion> motion;      // per vertex
  std::vector<std::uint8_t> full;  // per tetrahedron: any corner moves by itself
  std::vector<std::vector<Index>>
      embedded;  // per cell of the lattice: its tetrahedra with embedded corners alone
};

// `wanted`: per vertex, whether it is to move by itself. What shares a tetrahedron with a held vertex always
// does, so that held vertices stand still exactly and the lattice needs no boundary conditions.
Membership make_membership(const Elements& elements, const Lattice& lattice,
                           const std::vector<std::uint8_t>& held, const std::vector<std::uint8_t>& wanted);

}  // namespace lobe::reduced
