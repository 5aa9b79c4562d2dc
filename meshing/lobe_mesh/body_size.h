// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// How large a body is as its files have it, before it is repaired or meshed: for what is expected of a mesh.
#pragma once

#include <string>
#include <vector>

#include "lobe_mesh/label_image.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// Lengths are those of the coordinates that are given.
struct BodySize {
  // What becomes a label: one surface without those inside it, or the voxels of one value. Its area is that
  // of all walls around it, also towards other parts.
  struct Part {
    double volume = 0, area = 0;
  };
  Vec3d size = Vec3d::Zero();  // of the box around it; of an image, along its axes
  std::vector<Part> parts;
};

// Volumes count as positive, whichever way triangles face. The last `cavities` surfaces bound no part. Throws
// InputError for a surface that encloses nothing or has coordinates that are not finite. O(#surfaces ×
// #triangles).
BodySize size_of(const std::vector<Surface>& surfaces, std::size_t cavities = 0);

// Areas are those of the voxels' faces over 3/2, which is right for a ball. Throws InputError for an image
// that is all background. O(#voxels).
BodySize size_of(const LabelImage& image);

// `scale`: factor from these lengths to metres, as it was found or asked for.
std::string in_json(const BodySize& body, double scale);

}  // namespace lobe::meshing
