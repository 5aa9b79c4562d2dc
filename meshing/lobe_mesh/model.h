// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The closed surfaces that are meshed together: an organ, and in it a tumour, vessels, a cyst.
#pragma once

#include <vector>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// Label k is what surface k encloses, without what the surfaces inside it enclose.
struct Model {
  std::vector<Surface> surfaces;                // [m]
  std::vector<int> parents;                     // the surface just around each, −1: none
  std::vector<std::vector<Polyline>> features;  // of each surface

  int label_at(const Vec3d& point) const;  // −1: outside. O(#triangles)
  double volume_of(int label) const;       // [m³]
  double total_volume() const;             // [m³] inside any of the surfaces
};

// Throws InputError if a surface is not closed and manifold, or if two of them touch or intersect.
Model make_model(std::vector<Surface> surfaces);

// How often the surface winds around a point (solid angle / 4π): 1 inside, 0 outside or in a cavity.
double winding_number(const Surface& surface, const Vec3d& point);

// All of them as one, in their order.
Surface joined_surface(const std::vector<Surface>& surfaces);

}  // namespace lobe::meshing
