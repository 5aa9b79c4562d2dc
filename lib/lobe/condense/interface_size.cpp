#include "lobe/condense/interface_size.h"

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

}  // namespace lobe
