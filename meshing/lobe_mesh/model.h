// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What is meshed: regions with labels, and the surfaces between them. Either closed surfaces (an organ, and
// in it a tumour, vessels, a cyst), or a label image.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lobe_mesh/label_image.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// Of a surface: the regions on either side, −1 outside of the body.
struct Sides {
  int inside = 0, outside = -1;
};

// Of closed surfaces, region k is what surface k encloses, without what the surfaces inside it enclose. Of an
// image, and of closed surfaces that share walls or bound cavities, surface k is where two regions meet; it
// need not be closed, and its neighbours share its border.
struct Model {
  std::vector<Surface> surfaces;                // [m]
  std::vector<Sides> sides;                     // regions on both sides of each surface
  std::vector<std::vector<Polyline>> features;  // feature lines of each surface
  std::vector<int> labels;                      // label of each region in what is written
  std::vector<double> volumes;                  // volume of each region [m³]
  std::vector<std::string> warnings;
  std::vector<Mat3X<double>> junctions;           // lines where three or more regions meet [m]
  std::function<int(const Vec3d&)> image_region;  // region of a point of an image, −1: background; else empty

  bool is_image() const { return static_cast<bool>(image_region); }
  bool shares_walls() const { return !is_image() && !junctions.empty(); }
  int region_count() const { return static_cast<int>(labels.size()); }
  int region_of(int label) const;           // −1: there is no such label
  int region_at(const Vec3d& point) const;  // −1: outside. O(#triangles)
  double total_volume() const;              // [m³] of all regions
};

// The last `cavities` surfaces bound space that is not meshed. Throws InputError if a surface is not closed
// and manifold, or if two of them intersect or touch other than in the same triangles (shared_walls.h).
Model make_model(std::vector<Surface> surfaces, std::size_t cavities = 0);

// Throws InputError for what is no segmentation, see label_grid.h.
Model make_model(const LabelImage& image, double smoothing);  // [voxels]

// How often the surface winds around a point (solid angle / 4π): 1 inside, 0 outside or in a cavity.
double winding_number(const Surface& surface, const Vec3d& point);

// All of them as one, in their order.
Surface joined_surface(const std::vector<Surface>& surfaces);

}  // namespace lobe::meshing
