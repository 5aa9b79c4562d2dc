// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include "lobe/error.h"
#include "lobe_mesh/model.h"

namespace lobe::meshing {

// Two surfaces touch or intersect otherwise than a model of walls may have it: voxels can (voxels.h).
class SurfacesTouch : public InputError {
 public:
  using InputError::InputError;
};

// The model of closed surfaces that may share walls, with one surface between each two regions that meet.
// Points of two surfaces are the same if they are within 1e-6 of the whole diagonal; triangles with the same
// points are one wall. Where surfaces enclose the same space, it belongs to the one of least volume. The last
// `cavities` surfaces bound space that is not meshed. Throws SurfacesTouch if surfaces touch other than in
// whole triangles, edges or corners, or intersect, and InputError if one has no space of its own, or a cavity
// takes none.
// O(#triangles log #triangles), and O(#triangles) for each wall.
Model make_model_of_walls(const std::vector<Surface>& surfaces, std::size_t cavities);

}  // namespace lobe::meshing
