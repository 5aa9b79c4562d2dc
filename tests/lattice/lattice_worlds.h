// Bars of reduced regions, and what is measured of a world with such a region.
#pragma once

#include <algorithm>
#include <random>

#include "lattice_support.h"
#include "lobe/sim/world.h"

namespace lobe::test {

inline constexpr double edge = 0.01;

// A bar along x of cells of this size [m], jittered, held at x = 0 if asked.
inline Setup bar(int length, int width, bool is_held = true, RegionModel model = RegionModel::reduced,
                 double size = edge) {
  TetMesh mesh = box_mesh({length * size, width * size, width * size}, length, width, width);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.15 * size, 0.15 * size);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) > size / 2)
      for (int d = 0; d < 3; ++d) mesh.points(d, v) += jitter(random);
  Setup setup = setup_of(mesh, model);
  setup.lattice_cell = 2 * size;
  setup.volume_penalty = 1e5;
  for (Index v = 0; v < mesh.vertex_count() && is_held; ++v)
    if (mesh.points(0, v) < size / 2) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

inline Setup all_nonlinear(Setup setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  return setup;
}

inline std::vector<Index> vertices_near(const TetMesh& mesh, const Vec3d& at, double radius) {
  std::vector<Index> found;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if ((mesh.points.col(v) - at).norm() < radius) found.push_back(v);
  return found;
}

inline std::vector<Index> tets_near(const TetMesh& mesh, const Vec3d& at, double radius) {
  std::vector<Index> found;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if ((barycentre(mesh, t) - at).norm() < radius) found.push_back(t);
  return found;
}

// Pulled at its end and let go.
inline Setup pulled_bar(RegionModel model = RegionModel::reduced) {
  Setup setup = bar(16, 4, true, model);
  setup.damping = 20;
  setup.guard_below = 0.2;
  setup.grasps.push_back({"grasp",
                          vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.016),
                          {{0.05, Vec3d::Zero()}, {0.25, Vec3d(-0.01, 0.02, 0.03)}},
                          true});
  return setup;
}

inline const LatticeRegion<double>& region_of(const World<double>& world) {
  return world.body().regions.reduced();
}

inline MovingMasses::Momentum momentum_of(World<double>& world) {
  const auto& motion = world.body().motion;
  const auto& region = region_of(world);
  MovingMasses sum;
  for (Index v = 0; v < motion.u.count(); ++v)
    sum.add(world.body().inertia.mass()[std::size_t(v)], world.elements().points.col(v) + motion.u.col(v),
            motion.v.col(v));
  for (Index n = 0; n < region.lattice().node_count(); ++n)
    sum.add(region.embedding().mass[std::size_t(n)], region.lattice().nodes.col(n) + motion.nodes.u.col(n),
            motion.nodes.v.col(n));
  return sum.momentum();
}

inline double relative_error(const Mat3X<double>& u, const Mat3X<double>& exact) {
  return (u - exact).norm() / exact.norm();
}

}  // namespace lobe::test
