// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/label_layers.h"

#include <algorithm>
#include <set>
#include <utility>

namespace lobe::meshing {
namespace {

using Present = std::set<std::pair<std::size_t, std::int32_t>>;  // layer, value

Present present_in(const std::vector<std::int32_t>& values, std::size_t layers) {
  Present present;
  std::vector<std::int32_t> last(layers, 0);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] != 0 && std::exchange(last[i % layers], values[i]) != values[i])
      present.emplace(i % layers, values[i]);
  return present;
}

}  // namespace

MergedLayers merge_layers(const std::vector<std::int32_t>& values, std::size_t layers,
                          const std::vector<Segment>& named) {
  MergedLayers merged;
  const Present present = present_in(values, layers);
  const auto is_named = [&](const auto& entry) {
    return std::any_of(named.begin(), named.end(),
                       [&](const Segment& s) { return std::pair(s.layer, s.value) == entry; });
  };
  if (std::all_of(present.begin(), present.end(), is_named))
    merged.segments = named;
  else
    for (const auto& [layer, value] : present) merged.segments.push_back({layer, value});
  merged.values.assign(values.size() / layers, 0);
  for (std::size_t voxel = 0; voxel < merged.values.size(); ++voxel) {
    int segments = 0;
    for (std::size_t s = 0; s < merged.segments.size(); ++s) {
      const Segment& segment = merged.segments[s];
      if (values[voxel * layers + segment.layer] != segment.value) continue;
      merged.values[voxel] = static_cast<std::int32_t>(s + 1);
      ++segments;
    }
    merged.shared += segments > 1 ? 1 : 0;
  }
  return merged;
}

std::string words_of(const MergedLayers& merged) {
  std::string text = "its segments are in layers: ";
  for (std::size_t s = 0; s < merged.segments.size(); ++s) {
    const Segment& segment = merged.segments[s];
    text += (s > 0 ? ", " : "") + std::string("label ") + std::to_string(s + 1) + " is " +
            (segment.name.empty()
                 ? "the value " + std::to_string(segment.value) + " of layer " + std::to_string(segment.layer)
                 : segment.name);
  }
  if (merged.shared > 0)
    text += "; of several segments that overlap the last one is taken, in " + std::to_string(merged.shared) +
            (merged.shared == 1 ? " voxel" : " voxels");
  return text;
}

}  // namespace lobe::meshing
