// A bar along x, jittered, held at x = 0, whose vertices mostly follow a lattice.
#pragma once

#include "support.h"

namespace lobe::test {

inline Setup bar(int length, int width, RegionModel model = RegionModel::reduced, double edge = 0.01) {
  TetMesh mesh = box_mesh({length * edge, width * edge, width * edge}, length, width, width);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.15 * edge, 0.15 * edge);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) > edge / 2)
      for (int d = 0; d < 3; ++d) mesh.points(d, v) += jitter(random);
  Setup setup = setup_of(mesh, model);
  setup.lattice_cell = 2 * edge;
  setup.volume_penalty = 1e5;
  setup.damping = 20;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) < edge / 2) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

inline std::vector<Index> vertices_near(const TetMesh& mesh, const Vec3d& at, double radius) {
  std::vector<Index> found;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if ((mesh.points.col(v) - at).norm() < radius) found.push_back(v);
  return found;
}

inline Setup all_nonlinear(Setup setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  return setup;
}

}  // namespace lobe::test
