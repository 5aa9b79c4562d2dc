// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Closed surfaces as a label image: for surfaces that share walls or overlap, which are not meshed as they
// are.
#pragma once

#include <vector>

#include "lobe_mesh/label_image.h"
#include "lobe_mesh/surface.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// A voxel has the number of the last surface that encloses its centre, from 1; 0 outside of all, and where
// that surface is one of the last `cavities`. Throws InputError for an edge that is not positive, or so short
// that there would be more than half a billion voxels. O(#voxels + Σ over the triangles of the voxels across
// that they cover).
LabelImage voxelise(const std::vector<Surface>& surfaces, double edge,  // [m] of a voxel
                    std::size_t cavities = 0);

// As tetrahedralise() of the surfaces, but they may share walls and overlap: later surfaces win. Sharp edges
// are rounded by about a voxel, and parts thinner than two voxels may be lost. With Mesher::cgal only.
TetMesh tetrahedralise_voxels(const std::vector<Surface>& surfaces, double voxel, const MeshOptions& options,
                              MeshReport& report);

}  // namespace lobe::meshing
