// The body whose checkpoints and recordings are fuzzed.
#pragma once

#include "lobe/mesh/generators.h"
#include "lobe/setup/setup.h"

namespace lobe::fuzz {

inline Setup small_setup() {
  Setup setup;
  setup.mesh = box_mesh({0.02, 0.01, 0.01}, 2, 1, 1);
  setup.materials.emplace_back();
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.prescribed.push_back({0, Vec3d::Zero()});
  setup.guard_below = 0.2;
  setup.grasps.push_back({"hand", {1}, {{0, Vec3d::Zero()}}, false});
  return setup;
}

}  // namespace lobe::fuzz
