#include "benchmarks/reduced/membership.h"

namespace lobe::reduced {

Membership make_membership(const Elements& elements, const Lattice& lattice,
                           const std::vector<std::uint8_t>& held, const std::vector<std::uint8_t>& wanted) {
  const Tets& tets = elements.topology.tets();
  Membership made;
  made.motion.resize(held.size());
  for (std::size_t v = 0; v < held.size(); ++v)
    made.motion[v] = held[v] ? Motion::held : wanted[v] ? Motion::own : Motion::embedded;
  for (Index t = 0; t < tets.cols(); ++t) {
    bool any = false;
    for (int c = 0; c < 4; ++c) any |= held[tets(c, t)] != 0;
    for (int c = 0; any && c < 4; ++c)
      if (!held[tets(c, t)]) made.motion[tets(c, t)] = Motion::own;
  }
  made.full.assign(tets.cols(), 0);
  made.embedded.resize(lattice.tets.size());
  for (std::size_t cell = 0; cell < lattice.tets.size(); ++cell)
    for (Index t : lattice.tets[cell]) {
      int own = 0, embedded = 0;
      for (int c = 0; c < 4; ++c) {
        own += made.motion[tets(c, t)] == Motion::own;
        embedded += made.motion[tets(c, t)] == Motion::embedded;
      }
      made.full[t] = own > 0;
      if (embedded == 4) made.embedded[cell].push_back(t);
    }
  return made;
}

}  // namespace lobe::reduced
