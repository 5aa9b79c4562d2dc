// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The steps that repair_surface() and tetrahedralise() are made of, one CGAL translation unit each. All of
// them expect surfaces scaled to about unit size (UnitBox).
#pragma once

#include <utility>
#include <vector>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

struct MeshOptions;
struct RepairReport;

// Pairs of triangles that intersect other than in what they share. Welded surface expected; at most `most`.
std::vector<std::pair<Index, Index>> self_intersections(const Surface& surface, std::size_t most = 100000);

// The rungs of Repair::basic; each appends to the report what it changed.
Surface repair_by_rungs(const Surface& surface, double largest_hole, RepairReport& report);

// Closed surface around the whole, at `offset` from it, that bridges gaps narrower than `alpha`.
Surface alpha_wrap(const Surface& surface, double alpha, double offset);

// Largest distance from vertices and centres of triangles of one surface to the other, both ways.
double sampled_distance(const Surface& a, const Surface& b);

// Triangles of about the same size; feature lines stay.
Surface remesh(const Surface& surface, const std::vector<Polyline>& features, double edge);

// CGAL's Delaunay refinement (Mesh_3) and its optimisers. Stops with MeshingFailure after `time_limit` [s].
TetMesh mesh_with_cgal(const Surface& surface, const std::vector<Polyline>& features, double edge,
                       double time_limit);

// TetGen in a process of its own; the surface becomes the boundary of the mesh, triangle for triangle.
TetMesh mesh_with_tetgen(const Surface& surface, double edge, const MeshOptions& options);

// Moves interior vertices to where the smallest altitude around them is larger; the boundary stays.
void smooth_interior(TetMesh& mesh, int rounds);

// Removes almost flat tetrahedra that lie on the boundary with two faces; to the surface that is a flipped
// edge. Smoothing cannot help those whose vertices are all on the boundary.
void peel_flat_tets(TetMesh& mesh);

}  // namespace lobe::meshing
