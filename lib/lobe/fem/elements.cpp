#include "lobe/fem/elements.h"

#include <algorithm>

namespace lobe {

Elements::Elements(const Body& body)
    : topology(body.mesh),
      points(body.mesh.points),
      materials(body.materials),
      material_of(body.material_of),
      region_of(body.region_of),
      precomputed_frame(body.precomputed_frame),
      volume_penalty(body.volume_penalty),
      guard_below(body.guard_below) {
  const auto& given = body.mesh.labels;
  if (std::any_of(given.begin(), given.end(), [](int label) { return label != 0; })) labels = given;
}

double lumped_mass(const Elements& elements, Index vertex) {
  double mass = 0;
  for (Index t : elements.topology.around(vertex))
    mass += elements.elastic_of(t).density * signed_volume(elements.corner_points(t)) / 4;
  return mass;
}

}  // namespace lobe
