// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
// One try: the mesh of a mesher, and what is done to it.
#include <array>
#include <map>
#include <sstream>

#include "lobe/error.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/expected_tets.h"
#include "lobe_mesh/relax.h"
#include "lobe_mesh/sizing.h"
#include "lobe_mesh/tries.h"
#include "lobe_mesh/volumes.h"

namespace lobe::meshing {
namespace {

// Remeshing to this multiple of the edge gives boundary tetrahedra of the volume aimed at.
constexpr double surface_edge_factor = 1.08;

// Remeshing may fold thin parts onto themselves, which TetGen refuses: then a finer surface is tried.
Model remesh_without_intersections(const Model& model, double edge) {
  Model result = model;
  for (const double factor : {1.0, 0.85, 0.7, 0.5}) {
    for (std::size_t k = 0; k < model.surfaces.size(); ++k)
      result.surfaces[k] = remesh(model.surfaces[k], model.features[k], surface_edge_factor * factor * edge);
    if (diagnose(joined_surface(result.surfaces)).self_intersections.count == 0) return result;
  }
  throw MeshingFailure("remeshing left self-intersections: use --mesher cgal, or a shorter --edge");
}

// The repair separates bodies that touch along an edge or at a vertex, but leaves them in the same place.
// Mesh_3 refines there without end.
void refuse_touching(const Surface& surface) {
  std::map<std::array<double, 3>, Index> seen;
  for (Index v = 0; v < surface.points.cols(); ++v) {
    const Vec3d p = surface.points.col(v);
    if (seen.try_emplace({p.x(), p.y(), p.z()}, v).second) continue;
    std::ostringstream place;
    place << "two bodies touch at (" << p.x() << ", " << p.y() << ", " << p.z()
          << ") m: use --mesher tetgen, or move them apart";
    throw InputError("surface", place.str());
  }
}

}  // namespace

TetMesh Tries::mesh_with(Mesher mesher, double factor) {
  MeshOptions options = scaled_options_;
  options.time_limit = std::max(0.001, options_.time_limit - stopwatch_.elapsed());
  options.edge *= factor;
  if (mesher == Mesher::cgal) {
    if (!model_.is_image() && !model_.shares_walls()) refuse_touching(joined_surface(model_.surfaces));
    for (auto& [label, edge] : options.label_edges) edge *= factor;
    for (SizeBall& ball : options.balls) ball.edge *= factor;
    const Sizing sizing(scaled_, options);
    // Along the lines of shared walls the refinement asks about 13 times per tetrahedron instead of 6.
    const double work_per_tet = model_.shares_walls() ? 2 : 1;
    const MeshingRun run{sizing, seeds_, options.time_limit,
                         work_per_tet * expected_tets(with_edges_of_thin_labels(options, scaled_), scaled_),
                         [&](double done) { options.progress("mesh (cgal)", done); }};
    TetMesh mesh = model_.is_image() ? mesh_image_with_cgal(scaled_, run) : mesh_with_cgal(scaled_, run);
    stopwatch_.phase("cgal");
    return mesh;
  }
  options.progress("remesh", -1);
  const Model remeshed = remesh_without_intersections(scaled_, options.edge);
  stopwatch_.phase("remesh");
  options.progress("mesh (tetgen)", -1);
  TetMesh mesh = mesh_with_tetgen(remeshed, options.edge, options);
  peel_flat_tets(mesh);
  stopwatch_.phase("tetgen");
  return mesh;
}

void Tries::improve(TetMesh& mesh) {
  options_.progress("relax", -1);
  constexpr double on_line = 0.05;  // of the edge
  const double mean_edge = regular_edge(total_volume(mesh) / mesh.tet_count());
  const double shortest = report_.shortest_edge / unit_.size;
  const double edge = shortest < scaled_options_.edge ? shortest : mean_edge;
  const Freedom freedom = find_freedom(mesh, interfaces_, features_, on_line * edge);
  restore_volume(mesh, interfaces_, freedom);
  match_volumes(mesh, interfaces_, freedom, scaled_.volumes);
  relax(mesh, freedom,
        {.edge = edge, .poisson_ratio = options_.lambda / (2 * (options_.lambda + options_.mu))});
  match_volumes(mesh, interfaces_, freedom, scaled_.volumes);
  stopwatch_.phase("relax");
}

Remedy Tries::measure_gap(const TetMesh& mesh, MeshReport& report) const {
  const Surface faces = faces_of_surfaces(mesh);
  const NearestPoint faces_at(faces);
  const auto in_metres = [&](SurfaceGap gap) {
    for (double* length : {&gap.mean, &gap.percentile_95, &gap.largest}) *length *= unit_.size;
    gap.place = unit_.from_unit(gap.place);
    return gap;
  };
  const double spacing = point_spacing * scaled_options_.edge;
  report.surface_to_mesh = in_metres(gap_between(surface_points_, faces_at));
  report.mesh_to_surface = in_metres(gap_between(points_on(faces, spacing), surface_));
  const double bound = quality_gate.gap * report.longest_edge / unit_.size;
  Remedy remedy = remedy_for(surface_points_, surface_, faces_at, bound, spacing);
  report.keeping_edge = 0;
  for (const SizeBall& ball : remedy.balls)
    report.keeping_edge = report.keeping_edge == 0 ? unit_.size * ball.edge
                                                   : std::min(report.keeping_edge, unit_.size * ball.edge);
  return remedy;
}

}  // namespace lobe::meshing
