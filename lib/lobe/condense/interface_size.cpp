#include "lobe/condense/interface_size.h"

#include <cmath>
#include <string>

#include "lobe/error.h"

namespace lobe {

InterfaceSize interface_size(const Elements& elements, RegionModel model) {
  InterfaceSize size;
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) {
    Index inside = 0, outside = 0;
    for (Index t : elements.topology.around(v)) ++(elements.region_of[t] == model ? inside : outside);
    size.vertices += inside > 0 && outside > 0;
  }
  for (Index t = 0; t < elements.topology.tet_count(); ++t) size.tets += elements.is_in(model, t);
  return size;
}

void refuse_interface(Index components) {
  constexpr double most_bytes = 2e9;
  const double bytes = 88.0 * components * components;  // while it is condensed; afterwards half of it
  if (bytes <= most_bytes) return;
  throw InputError("precomputed region",
                   "its interface of " + std::to_string(components / 3) + " vertices would take " +
                       std::to_string(std::lround(bytes / 1e6)) + " MB of dense matrices; at most " +
                       std::to_string(std::lround(most_bytes / 1e6)) +
                       " MB are used: let it end at a narrower part of the body, or make it tensor-mass");
}

}  // namespace lobe
