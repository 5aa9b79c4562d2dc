// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// How many tetrahedra a mesh will have. Internal.
#pragma once

#include "lobe_mesh/model.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// 2 V/A of a region: of a thin layer its thickness, of a cube or a ball a third of its size.
double edge_within(const Model& model, int region);

// Whether edges that short may be chosen for a region without being asked for.
bool keeps_few_tets(const Model& model, int region, double edge);

// About how many tetrahedra the edges asked for give, with those that grow around shorter ones.
double expected_tets(const MeshOptions& options, const Model& model);

// What CGAL's refinement makes of a layer that is thinner than an edge: its surfaces stay apart only with
// edges about as short as it is thick.
MeshOptions with_edges_of_thin_labels(MeshOptions options, const Model& model);

}  // namespace lobe::meshing
