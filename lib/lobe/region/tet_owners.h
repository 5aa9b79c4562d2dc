// Which smoothing domain computes the volume term and the guard of an edge-smoothed tetrahedron. Both act at
// the det F of the tetrahedron itself. Each tetrahedron is given to one of its six domains, which has
// gathered its vertices already and adds up forces on them. A domain takes as many as it can, so that few
// have any.
#pragma once

#include <span>
#include <vector>

#include "lobe/region/smoothed_edges.h"

namespace lobe {

class TetOwners {
 public:
  // Follows the tetrahedra of SmoothedEdges::follow(), after it. Only the domains that it returned change.
  void follow(const SmoothedEdges& edges, const std::vector<Index>& leave, const std::vector<Index>& enter);
  std::span<const Index> of(Index edge) const {  // tetrahedra that it owns
    if (edge >= tets_of_.vertex_count()) return {};
    return tets_of_[edge];
  }

 private:
  void give(const SmoothedEdges& edges, Index edge);

  std::vector<Index> owner_;    // domain of each tetrahedron; −1 if none
  VertexLists<Index> tets_of_;  // tetrahedra of each domain
};

// The tetrahedra of a domain of an edge (a, b), as chains: each is (a, b, r_i, r_i+1) of a ring.
struct TetChain {
  // Numbers of the domain's vertices: a, b, the chain, the rest. A closed ring has its first vertex twice.
  std::vector<std::uint8_t> order;
  std::vector<Index> tets;  // tetrahedra between the third and the fourth of these, and so on; −1: none
};
void find_tet_chain(const Topology& topology, const SmoothedEdge& edge, std::span<const Index> tets,
                    TetChain& chain);

}  // namespace lobe
