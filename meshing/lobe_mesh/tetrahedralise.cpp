// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/tetrahedralise.h"

#include <cmath>
#include <sstream>

#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/expected_tets.h"
#include "lobe_mesh/mesh_model.h"
#include "lobe_mesh/tries.h"

namespace lobe::meshing {
namespace {

// The refinement of an image separates the labels, but the boundary of the mesh may touch itself where the
// boundary of the labels does.
void warn_of_pinches(const TetMesh& mesh, MeshReport& report) {
  const Diagnosis boundary = diagnose(boundary_surface(mesh));
  for (const Finding* finding : {&boundary.non_manifold_edges, &boundary.non_manifold_points}) {
    if (finding->count == 0) continue;
    report.warnings.push_back("the boundary of the mesh touches itself: " + finding->counted() + ", first " +
                              finding->places.front() +
                              "; choose a shorter --edge, or separate the parts there");
  }
}

// A label that is smaller than an edge gets edges of a third of its size, unless it has others already. Where
// thin parts are kept, a layer that is thinner than half an edge gets edges of its thickness, unless these
// are too many.
void shorten_for_small_labels(const Model& model, MeshOptions& options, std::vector<std::string>& notes) {
  if (options.mesher != Mesher::cgal) return;
  for (int region = 0; region < model.region_count(); ++region) {
    const double edge = edge_within(model, region);
    const int label = model.labels[std::size_t(region)];
    const bool is_small = 3 * edge < options.edge,
               is_thin = options.keep_thin && 2 * edge < options.edge && keeps_few_tets(model, region, edge);
    if (!(edge > 0) || !(is_small || is_thin) || options.label_edges.contains(label)) continue;
    options.label_edges[label] = edge;
    notes.push_back("label " + std::to_string(label) +
                    (is_small ? " is smaller than an edge" : " is thinner than half an edge") +
                    ": its edges are " + rounded(edge) + " m (--label-edge " + std::to_string(label) +
                    "=EDGE for others)");
  }
}

// The option that keeps thin parts, where it has not been asked for.
std::string thin_option(const MeshOptions& options) {
  if (options.mesher == Mesher::tetgen) return "--mesher cgal --keep-thin";
  return options.keep_thin ? "" : "--keep-thin";
}

std::string words_of_gap(const MeshReport& report, const MeshOptions& options) {
  const SurfaceGap& gap = report.surface_to_mesh;
  const std::string thin = thin_option(options);
  std::ostringstream text;
  text << "parts of the surface are missing from the mesh: the surface is up to " << rounded(gap.largest)
       << " m from it, at (" << rounded(gap.place.x()) << ", " << rounded(gap.place.y()) << ", "
       << rounded(gap.place.z()) << ") m; edges of " << rounded(report.keeping_edge)
       << " m would keep them (--edge " << rounded(report.keeping_edge)
       << (thin.empty() ? "" : ", or " + thin + " for such edges only there") << ")";
  return text.str();
}

// The bounds of the gate that a mesh misses.
std::string missed_bounds(const MeshReport& report) {
  std::string missed = report.missing_labels() > 0 ? "a label has no tetrahedra" : "";
  const auto miss = [&](bool is_missed, const std::string& what, double bound, const char* unit) {
    if (is_missed) missed += (missed.empty() ? "" : ", ") + what + " " + rounded(bound) + unit;
  };
  const Quality& quality = report.quality;
  const double angle = quality.min_dihedral, altitude = quality.smallest_altitude_ratio,
               step = report.time_step_star, gap = report.largest_gap(),
               largest_gap = quality_gate.gap * report.longest_edge;
  miss(angle < quality_gate.min_dihedral, "smallest dihedral angle " + rounded(angle) + "°, at least",
       quality_gate.min_dihedral, "°");
  miss(altitude < quality_gate.smallest_altitude_ratio,
       "smallest altitude " + rounded(altitude) + " of the edge, at least",
       quality_gate.smallest_altitude_ratio, "");
  miss(step < quality_gate.time_step_star, "dt* " + rounded(step) + ", at least", quality_gate.time_step_star,
       "");
  miss(report.missing_labels() == 0 && report.lost_volume() > quality_gate.lost_volume,
       rounded(std::round(report.lost_volume())) + " % of a label's volume lost, at most",
       quality_gate.lost_volume, " %");
  miss(gap > largest_gap, rounded(gap) + " m between surface and mesh, at most", largest_gap, " m");
  return missed;
}

// Names what may help and has not been asked for.
std::string words_of_gate(const MeshReport& report, const Model& model, const MeshOptions& options) {
  const std::string thin = thin_option(options);
  return "the mesh is below the gate (" + missed_bounds(report) + "): try " +
         (thin.empty() ? "" : thin + " (shorter edges along thin parts), ") + "another --edge, " +
         (model.is_image() ? "or a larger --smoothing"
                           : "--feature-angle 180 (keeps no edge sharp), or smooth the surface there");
}

}  // namespace

TetMesh mesh_model(const Model& model, const MeshOptions& options, MeshReport& report) {
  report = {};
  MeshOptions chosen = options;
  if (options.edge == 0) {
    chosen.edge = default_edge(model.surfaces);
    chosen.keep_thin = true;
  }
  std::vector<std::string> notes;
  if (options.mesher == Mesher::cgal && chosen.edge > 0) shorten_for_small_labels(model, chosen, notes);
  check_options(chosen, model);
  report.edge = chosen.edge;
  TetMesh mesh = Tries(model, chosen, report).best();
  if (model.is_image()) warn_of_pinches(mesh, report);
  for (int& label : mesh.labels) label = model.labels[label];
  report.warnings.insert(report.warnings.begin(), notes.begin(), notes.end());
  report.warnings.insert(report.warnings.begin(), model.warnings.begin(), model.warnings.end());
  if (report.keeping_edge > 0) report.warnings.push_back(words_of_gap(report, chosen));
  if (!report.passes()) report.warnings.push_back(words_of_gate(report, model, chosen));
  return mesh;
}

double default_edge(const std::vector<Surface>& surfaces) {
  return box_diagonal(joined_surface(surfaces)) / 25;
}

TetMesh tetrahedralise(const std::vector<Surface>& surfaces, const MeshOptions& options, MeshReport& report) {
  return mesh_model(make_model(surfaces, options.cavities), options, report);
}

TetMesh tetrahedralise(const LabelImage& image, const MeshOptions& options, MeshReport& report) {
  return mesh_model(make_model(image, options.smoothing), options, report);
}

}  // namespace lobe::meshing
