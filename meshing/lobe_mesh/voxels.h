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

// Of surfaces that enclose the same space.
enum class Winner { later, smaller };  // by their order, or by the volumes that they enclose

// A voxel has the number of the surface that encloses its centre, from 1, of several that of the winner; 0
// outside of all, and in the last `cavities` surfaces, which win in any case. Throws InputError for an edge
// that is not positive, or so short that there would be more than half a billion voxels, for a surface that
// has no voxel, and for a cavity that takes none. O(#voxels + Σ over the triangles of the voxels across that
// they cover).
LabelImage voxelise(const std::vector<Surface>& surfaces, double edge,  // [m] of a voxel
                    std::size_t cavities = 0, Winner winner = Winner::later);

// The longest edge of voxels tried [m], at most `longest`, by which each surface keeps its volume but for
// quality_gate.lost_volume; 0: none of at most 20 million voxels does, or the volume is not positive. Shorter
// ones than `longest` are tried from half the thickness of the thinnest surface on.
double voxels_that_keep(const std::vector<Surface>& surfaces, double longest, std::size_t cavities,
                        Winner winner, double smoothing);  // [voxels]

// As tetrahedralise() of the surfaces, but they may share walls and overlap. Sharp edges are rounded by about
// a voxel, and parts thinner than two voxels may be lost. Throws InputError where a surface loses more than
// quality_gate.lost_volume, with an edge that keeps it; with options.accepts_loss that is a warning. With
// Mesher::cgal only.
TetMesh tetrahedralise_voxels(const std::vector<Surface>& surfaces, double voxel, const MeshOptions& options,
                              MeshReport& report, Winner winner = Winner::later);

}  // namespace lobe::meshing
