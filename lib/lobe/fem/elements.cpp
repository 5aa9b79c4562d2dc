#include "lobe/fem/elements.h"

#include <algorithm>

namespace lobe {

Elements::Elements(const Body& body)
    : topology(body.mesh),
      points(body.mesh.points),
      bodies(body.mesh.bodies),
      fibres(body.mesh.fibres),
      materials(body.materials),
      material_of(body.material_of),
      region_of(body.region_of),
      shares(body.shares),
      precomputed_frame(body.precomputed_frame),
      volume_penalty(body.volume_penalty),
      guard_below(body.guard_below) {
  const auto& given = body.mesh.labels;
  if (std::any_of(given.begin(), given.end(), [](int label) { return label != 0; })) labels = given;
  corner_volumes.resize(std::size_t(topology.tet_count()));
  for (Index t = 0; t < topology.tet_count(); ++t) corner_volumes[t] = volume(t) / 4;
  // Room for copies, so that a first cut copies no list. Until it is touched, it takes no memory.
  const auto tets = std::size_t(topology.tet_count()), room = tets + tets / 4;
  if (!labels.empty()) labels.reserve(room);
  if (bodies.any()) bodies.of.reserve(room);
  material_of.reserve(room);
  region_of.reserve(room);
  corner_volumes.reserve(room);
}

void Elements::follow(const MeshEdit& edit) {
  points.extend(topology.vertex_count());
  for (const VertexSplit& split : edit.splits) points.col(split.copy) = points.col(split.vertex);
  for (const TetCopy& tet_copy : edit.copies) {
    if (!labels.empty()) labels.push_back(labels[tet_copy.tet]);
    if (bodies.any()) bodies.of.push_back(bodies.of[tet_copy.tet]);
    material_of.push_back(material_of[tet_copy.tet]);
    region_of.push_back(region_of[tet_copy.tet]);
  }
  if (fibres.cols() > 0 && !edit.copies.empty()) {
    Eigen::Index at = fibres.cols();
    fibres.conservativeResize(Eigen::NoChange, topology.tet_count());
    for (const TetCopy& tet_copy : edit.copies) fibres.col(at++) = fibres.col(tet_copy.tet);
  }
  if (edit.shares.empty()) return;
  shares.resize(std::size_t(topology.tet_count()), 1);
  corner_volumes.resize(shares.size());
  for (const TetShare& tet_share : edit.shares) {
    shares[tet_share.tet] = tet_share.share;
    corner_volumes[tet_share.tet] = volume(tet_share.tet) / 4;
  }
}

double lumped_mass(const Elements& elements, Index vertex) {
  double mass = 0;
  for (Index t : elements.topology.around(vertex))
    mass += elements.elastic_of(t).density * elements.corner_volumes[t];
  return mass;
}

}  // namespace lobe
