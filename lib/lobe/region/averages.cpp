#include "lobe/region/averages.h"

#include <algorithm>

namespace lobe {

// The mean over the six domains of a tetrahedron is that over its four nodes: three edges meet at each.
std::vector<double> tet_pressures(const Elements& elements, const Averages& averages,
                                  const Mat3X<double>& u) {
  std::vector<double> pressures = tet_pressures(elements, averages.nodes, u);
  if (!averages.edge_pressures.any()) return pressures;
  const std::vector<double> of_domains =
      domain_pressures(averages.edges, averages.edge_pressures, domain_gradients(averages.edges, u));
  for (Index t = 0; t < static_cast<Index>(pressures.size()); ++t)
    for (Index e : averages.edges.of(t))
      if (e >= 0) pressures[t] += of_domains[e] / 6;
  return pressures;
}

}  // namespace lobe
