// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The steps that repair_surface() and tetrahedralise() are made of, one CGAL translation unit each. All of
// them expect surfaces scaled to about unit size (UnitBox).
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

struct MeshOptions;
struct Model;
struct RepairReport;
class Sizing;

// Pairs of triangles that intersect other than in what they share. Welded surface expected; at most `most`.
std::vector<std::pair<Index, Index>> self_intersections(const Surface& surface, std::size_t most = 100000);

// The steps of Repair::basic. Each appends to the report what it changed, and then hands its result to
// `done`.
Surface repair_in_steps(const Surface& surface, double largest_hole, RepairReport& report,
                        const std::function<void(const Surface&)>& done);

// Closed surface around the whole, at `offset` from it, that bridges gaps narrower than `alpha`.
Surface alpha_wrap(const Surface& surface, double alpha, double offset);

// Triangles of about the same size; feature lines stay.
Surface remesh(const Surface& surface, const std::vector<Polyline>& features, double edge);

// A point on a surface of the model.
struct Seed {
  Vec3d point = Vec3d::Zero();
  std::size_t surface = 0;
  Index triangle = 0;
};

struct MeshingRun {
  const Sizing& sizing;
  const std::vector<Seed>& seeds;             // points from which the refinement starts besides its own
  double time_limit;                          // [s]
  double expected_tets;                       // total for `progress`
  std::function<void(double done)> progress;  // 0 … 1
};

// CGAL's Delaunay refinement (Mesh_3). Stops with MeshingFailure when the time is over.
TetMesh mesh_with_cgal(const Model& model, const MeshingRun& run);
TetMesh mesh_image_with_cgal(const Model& model, const MeshingRun& run);  // meshes a label image

// TetGen in a process of its own; the surfaces become the faces of the mesh, triangle for triangle.
TetMesh mesh_with_tetgen(const Model& model, double edge, const MeshOptions& options);

// Removes almost flat tetrahedra that lie on the boundary with two faces; to the surface that is a flipped
// edge. Moving vertices cannot help those that lie on the boundary with all four.
void peel_flat_tets(TetMesh& mesh);

}  // namespace lobe::meshing
