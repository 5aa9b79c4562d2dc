// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Segments that may overlap, as 3D Slicer stores them: several layers of voxels, each with values of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lobe::meshing {

struct Segment {
  std::size_t layer = 0;
  std::int32_t value = 1;  // value of its voxels in that layer
  std::string name = {};
};

struct MergedLayers {
  std::vector<std::int32_t> values;  // one label per voxel: 1, 2, … of the segments; 0: of none
  std::vector<Segment> segments;     // segments in the order of their labels
  std::size_t shared = 0;            // voxels of several segments, which have the label of the last one
};

// `values`: of each voxel those of all layers, one after the other. Where a value above 0 is none of these
// segments, they are not those of the file: then each value of each layer is one, layer by layer, ascending.
// O(#values #segments).
MergedLayers merge_layers(const std::vector<std::int32_t>& values, std::size_t layers,
                          const std::vector<Segment>& named);

// For people: which segment has which label.
std::string words_of(const MergedLayers& merged);

}  // namespace lobe::meshing
