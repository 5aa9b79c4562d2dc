// A block that blades cut, and recordings of it that are changed.
#pragma once

#include <type_traits>

#include "lobe/run/recording.h"
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

template <class T, class Recorded>
T* part(Recorded& recorded) {
  auto* command = std::get_if<Command>(&recorded.command);
  return command ? std::get_if<std::remove_const_t<T>>(command) : nullptr;
}

inline std::vector<Advance*> frames_with_cuts(Recording& recording) {
  std::vector<Advance*> frames;
  for (RecordedCommand& recorded : recording.commands)
    if (auto* advance = part<Advance>(recorded); advance && !advance->cuts.empty()) frames.push_back(advance);
  return frames;
}

// Takes all blades elsewhere.
inline Recording displaced(Recording recording, const Vec3d& by) {
  for (RecordedCommand& recorded : recording.commands)
    if (auto* lead = part<Lead>(recorded)) lead->target.position += by;
  return recording;
}

inline Recording without_cuts(Recording recording) {
  for (Advance* advance : frames_with_cuts(recording)) advance->cuts.clear();
  return recording;
}

}  // namespace lobe::test
