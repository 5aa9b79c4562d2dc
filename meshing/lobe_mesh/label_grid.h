// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// A label image as a partition of space: which region a point belongs to, anywhere between the voxels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lobe_mesh/label_image.h"
#include "lobe_mesh/model.h"

namespace lobe::meshing {

// Region r (from 1) are the voxels of value values[r − 1]; region 0 is the background. Cropped to what is not
// background, with a margin of background around it.
//
// The staircase of the voxels is smoothed: with 1_r the indicator of a region and G a Gaussian of σ =
// `smoothing` voxels, φ_r = (2 + √2) G 1_r − (1 + √2) G G 1_r. G alone moves the level 1/2 of a ball of
// radius R inwards by σ²/R, and G G, whose slope there is smaller by √2, by 2 σ²/R: their sum leaves it in
// its place. Σ φ_r = 1. A voxel belongs to the region of the largest φ, with the lead over the second largest
// as weight. A point between voxels belongs to the region whose weights, interpolated linearly, are largest;
// where two regions meet, that is the level φ_1 = φ_2 of the interpolated φ.
struct LabelGrid {
  std::array<Index, 3> first{}, size{};  // its first voxel in the image; voxels along i, j, k
  std::vector<std::uint8_t> regions;     // region of each voxel, i fastest
  std::vector<float> margins;            // weight of each voxel, in (0, 1]
  Mat34<double> to_world = Mat34<double>::Zero();
  std::vector<int> values;            // values of the image, ascending
  std::vector<double> volumes;        // volume of each region [m³]: of its surface, or of an image's voxels
  std::vector<double> kept;           // share of it that the smoothed voxels have
  std::vector<std::string> warnings;  // losses by the smoothing

  std::size_t index(Index i, Index j, Index k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(size[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(k));
  }
};

// Throws InputError: nothing but background, one value only, negative values, more than 250 values, a label
// of an image that the smoothing removes (of surfaces, `kept` is 0). O(#voxels in the boxes of the labels).
LabelGrid make_label_grid(const LabelImage& image, double smoothing);  // [voxels], 0: none

// Finds the region of a point, 0 outside of the grid.
class RegionAt {
 public:
  explicit RegionAt(const LabelGrid& grid);
  int operator()(const Vec3d& point) const;  // [m]

 private:
  const LabelGrid& grid_;
  Mat34<double> to_grid_;
};

// The interfaces between the regions, by dual contouring: a vertex in every cube of eight voxels that are not
// all of one region, at the mean of the crossings on its edges.
struct LabelSurfaces {
  std::vector<Surface> surfaces;         // one per pair of regions that meet
  std::vector<Sides> sides;              // regions on both sides of each
  std::vector<Mat3X<double>> junctions;  // lines where three or more regions meet, smoothed
};
LabelSurfaces label_surfaces(const LabelGrid& grid);

// What is meshed of a grid that keeps something of each label.
Model make_model(LabelGrid grid);

}  // namespace lobe::meshing
