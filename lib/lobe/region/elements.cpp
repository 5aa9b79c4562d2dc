#include "lobe/region/elements.h"

namespace lobe {

Elements::Elements(const Setup& setup)
    : topology(setup.mesh),
      points(setup.mesh.points),
      labels(setup.mesh.labels),
      materials(setup.materials),
      material_of(setup.material_of),
      region_of(setup.region_of),
      volume_penalty(setup.volume_penalty) {}

Mat34<double> Elements::corner_points(Index tet) const {
  Mat34<double> X;
  for (int c = 0; c < 4; ++c) X.col(c) = points.col(topology.tets()(c, tet));
  return X;
}

double lumped_mass(const Elements& elements, Index vertex) {
  double mass = 0;
  for (Index t : elements.topology.around(vertex))
    mass += elements.elastic_of(t).density * signed_volume(elements.corner_points(t)) / 4;
  return mass;
}

}  // namespace lobe
