// The shipped liver as benchmarks of hands take it: all non-linear, and held at its right.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe::bench {

inline const Vec3d left_tip{0.082, -0.045, 0.035};  // of the left lobe [m]

inline Setup held_liver(const TetMesh& mesh) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 20;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) < -0.02 && mesh.points(1, v) > 0.015)
      setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

}  // namespace lobe::bench
