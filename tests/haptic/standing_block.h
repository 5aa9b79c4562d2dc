// A block of 5 cm that stands on z = 0, without gravity, and ways for a tool above its middle.
#pragma once

#include "support.h"

namespace lobe::test {

inline const Vec3d downwards{0, 0, -1}, sideways{1, 0, 0};
inline constexpr double approach = 0.004;  // of a sphere through free space [m]

inline Setup standing_block() {
  Setup setup = hybrid_setup(irregular_box(5));
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

}  // namespace lobe::test
