// A body of which half is pre-computed, for the tests of this folder.
#pragma once

#include "lobe/sim/world.h"
#include "support.h"

namespace lobe::test {

// A box whose half with the smaller x is linear, held at x = 0, where one vertex slides along the wall; the
// other half is non-linear.
inline Setup half_linear(RegionModel model, int n = 5) {
  const TetMesh mesh = irregular_box(n);
  Setup setup = hybrid_setup(mesh);
  for (RegionModel& region : setup.region_of)
    if (region == RegionModel::tensor_mass) region = model;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) < 0.003)
      setup.prescribed.push_back({v, Vec3d::Zero(), v == (n + 1) * 3 ? Axes{true, false, false} : all_axes});
  return setup;
}

// Gravity, and forces on vertices of both halves.
inline void load(Setup& setup) {
  setup.gravity = {0, 1, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); v += 7)
    setup.vertex_loads.push_back({v, {0.002, 0.001, -0.003}});
}

template <class Real>
State<Real> random_state(World<Real>& world, double size) {
  State<Real> state = world.state();
  state.u = random_displacement<Real>(static_cast<Index>(state.u.cols()), size);
  for (const HeldVertices::Held& item : world.held().all())
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) state.u(axis, item.vertex) = 0;
  return state;
}

}  // namespace lobe::test
