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

// change(entry) for each entry.
template <class Change>
Recording with_changed_entries(Recording recording, Change&& change) {
  std::vector<RecordedCommand> entries = recording.commands.all();
  for (RecordedCommand& entry : entries) change(entry);
  recording.commands = CommandLog(entries);
  return recording;
}

// change(frame) for each frame with cuts.
template <class Change>
Recording with_changed_cuts(const Recording& recording, Change&& change) {
  return with_changed_entries(recording, [&](RecordedCommand& entry) {
    if (auto* advance = part<Advance>(entry); advance && !advance->cuts.empty()) change(*advance);
  });
}

// Takes all blades elsewhere.
inline Recording displaced(const Recording& recording, const Vec3d& by) {
  return with_changed_entries(recording, [&](RecordedCommand& entry) {
    if (auto* lead = part<Lead>(entry)) lead->target.position += by;
  });
}

inline Recording without_cuts(const Recording& recording) {
  return with_changed_cuts(recording, [](Advance& frame) { frame.cuts.clear(); });
}

}  // namespace lobe::test
