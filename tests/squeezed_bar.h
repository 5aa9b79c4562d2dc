// A body that stays crushed although nobody holds it there.
#pragma once

#include "support.h"

namespace lobe::test {

// 144 tetrahedra, held at their low end. Everything moves slowly.
inline Setup slow_bar() {
  Setup setup = setup_of(box_mesh({0.06, 0.02, 0.02}, 6, 2, 2));
  setup.guard_below = 0.2;
  setup.damping = 1000;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.001) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

// Two loads of 60 N against each other crush its last cells.
inline Setup squeezed_bar() {
  Setup setup = slow_bar();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const double x = setup.mesh.points(0, v); x > 0.049)
      setup.vertex_loads.push_back({v, {x > 0.059 ? -60.0 / 9 : 60.0 / 9, 0, 0}});
  return setup;
}

}  // namespace lobe::test
