// A block that blades cut while it sinks.
#pragma once

#include "strokes.h"
#include "world_support.h"

namespace lobe::test {

inline constexpr double frame = 1.0 / 60;  // [s]

// A block of 5 cm that stands on z = 0 and sinks by its weight.
inline Setup sinking_block(RegionModel model = RegionModel::nonlinear) {
  Setup setup = setup_of(irregular_box(5));
  setup.materials = {{1.2e4, 3e3, 1000}};
  setup.gravity = {0, 0, -9.81};
  setup.damping = 15;
  setup.expandable = model == RegionModel::precomputed;
  setup.region_of.assign(setup.region_of.size(), model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

}  // namespace lobe::test
