// A liver of 2,000 tetrahedra, held at its back, and the place where its left lobe is taken hold of.
#pragma once

#include "lobe/io/mesh_io.h"
#include "support.h"

namespace lobe::test {

inline Setup held_liver(RegionModel model = RegionModel::nonlinear) {
  Setup setup =
      setup_of(read_mesh(std::filesystem::path(LOBE_DATA_DIR) / "meshes" / "liver_2k.vtu").mesh, model);
  setup.volume_penalty = 1e5;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d x = setup.mesh.points.col(v);
    if (x.x() < -0.02 && x.y() > 0.015) setup.prescribed.push_back({v, Vec3d::Zero()});
  }
  return setup;
}

inline std::vector<Index> left_lobe(const Setup& setup) {
  std::vector<Index> vertices;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if ((setup.mesh.points.col(v) - Vec3d(0.082, -0.045, 0.035)).norm() < 0.02) vertices.push_back(v);
  return vertices;
}

}  // namespace lobe::test
