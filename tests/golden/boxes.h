// Boxes that golden runs pull, cut and burn.
#pragma once

#include "condense/half_linear.h"
#include "lobe/setup/setup.h"

namespace lobe::test {

inline constexpr int frames = 20;
inline constexpr double frame = 0.02;  // [s]

inline const auto nothing = [](auto&) { return [](int) {}; };

// A box of 5 × 5 × 5 cells of 0.01 m, of which the half with the smaller x follows another model.
inline Setup box_of(RegionModel model) {
  Setup setup = half_linear(model);
  load(setup);
  setup.damping = 10;
  return setup;
}

// Takes hold of the upper end, moves it sideways and lets go at half of the time.
inline void add_grasp(Setup& setup) {
  GraspSetup grasp{"grasp", {}, {{0.04, Vec3d::Zero()}, {0.2, {0.006, 0.004, 0.002}}}, true};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.045) grasp.vertices.push_back(v);
  setup.grasps.push_back(grasp);
}

// Through the non-linear half and into the other one.
inline void add_cautery(Setup& setup) {
  setup.cauteries.push_back({"cautery", 0.006, {{0.1, {0.06, 0.025, 0.05}}, {0.3, {0.005, 0.025, 0.05}}}});
}

inline Setup box_with_tools(RegionModel model) {
  Setup setup = box_of(model);
  add_grasp(setup);
  add_cautery(setup);
  return setup;
}

// A blade falls through both halves, which a grasp pulls; then a cautery burns through its cut.
inline Setup box_with_blade(RegionModel model) {
  Setup setup = box_with_tools(model);
  for (PathPoint& row : setup.cauteries[0].path) row.time += 0.1;
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.1, {-0.01, 0.021, 0.06}}, {0.2, {-0.01, 0.024, 0.012}}},
                            {{0.06, 0.023, 0.062}, {0.06, 0.027, 0.008}}});
  return setup;
}

}  // namespace lobe::test
