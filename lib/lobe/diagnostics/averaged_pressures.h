// Nodal pressures for the stresses of a frame.
#pragma once

#include "lobe/region/averages.h"

namespace lobe {

// tet_pressures(), without finding averages where no material has nodal pressure: they are built anew for
// each frame.
inline std::vector<double> averaged_pressures(const Elements& elements, const Mat3X<double>& u) {
  if (any_nodal_pressure(elements.materials)) return tet_pressures(elements, Averages(elements), u);
  return std::vector<double>(std::size_t(elements.topology.tet_count()), 0.0);
}

}  // namespace lobe
