// What couples tetrahedra of a body beyond the vertices that they share: smoothing domains, and the nodes of
// averaged pressures, of plain tetrahedra and of domains.
#pragma once

#include "lobe/region/edge_pressures.h"
#include "lobe/region/nodal_pressure.h"

namespace lobe {

struct Averages {
  explicit Averages(const Elements& elements)
      : nodes(elements), edges(elements), edge_pressures(elements, edges) {}

  PressureNodes nodes;  // nodes of plain tetrahedra
  SmoothedEdges edges;
  EdgePressures edge_pressures;
};

// p_T [Pa] of every tetrahedron, the mean of its nodes', 0 where it takes no part. O(#tetrahedra).
std::vector<double> tet_pressures(const Elements& elements, const Averages& averages,
                                  const Mat3X<double>& u);  // 3 × #vertices [m]

}  // namespace lobe
