// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/measure.h"

#include <algorithm>
#include <cmath>

#include "lobe/sim/rest_time_step.h"
#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/expected_tets.h"
#include "lobe_mesh/relax.h"

namespace lobe::meshing {
namespace {

void warn_of_volume(const std::string& whose, double error, const std::string& remedy, MeshReport& report) {
  if (std::abs(error) <= kept_volume) return;
  report.warnings.push_back(whose + " differs from the input's by " + rounded(std::round(10 * error) / 10) +
                            " %: " + remedy);
}

std::string remedy_for_label(const Model& model, int region, const MeshOptions& options,
                             const MeshReport& report) {
  const double edge = edge_within(model, region);
  return "choose a shorter edge for it (--label-edge " + std::to_string(model.labels[std::size_t(region)]) +
         "=" + (edge > 0 && edge < report.edge ? rounded(edge) : "EDGE") +
         (options.keep_thin || options.mesher != Mesher::cgal ? ")" : ", or --keep-thin)");
}

void measure_parts(const TetMesh& mesh, const Model& model, const MeshOptions& options, MeshReport& report) {
  report.parts.assign(model.labels.size(), {});
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    MeshReport::Part& part = report.parts[mesh.labels[t]];
    ++part.tets;
    part.volume += signed_volume(tet_points(mesh, t));
  }
  for (std::size_t k = 0; k < report.parts.size(); ++k) {
    MeshReport::Part& part = report.parts[k];
    part.label = model.labels[k];
    part.surface_volume = model.volumes[k];
    const std::string label = std::to_string(part.label);
    const std::string remedy = remedy_for_label(model, int(k), options, report);
    if (part.tets == 0)
      report.warnings.push_back("no tetrahedra in label " + label + ": " + remedy);
    else if (report.parts.size() > 1)
      warn_of_volume("the volume of label " + label, part.volume_error(), remedy, report);
  }
}

void measure_faces(const TetMesh& mesh, MeshReport& report) {
  report.boundary_faces = 0;
  for (const InterfaceFace& face : interface_faces(mesh)) {
    if (face.other >= 0) continue;
    ++report.boundary_faces;
    const auto& c = face.corners;
    if (std::find(c.begin(), c.end(), report.bottleneck.vertex) != c.end())
      report.bottleneck.on_boundary = true;
  }
}

}  // namespace

Index MeshReport::missing_labels() const {
  return static_cast<Index>(
      std::count_if(parts.begin(), parts.end(), [](const Part& part) { return part.tets == 0; }));
}

double largest_volume_error(const MeshReport& report) {
  double largest = 0;
  for (const MeshReport::Part& part : report.parts)
    if (part.tets > 0) largest = std::max(largest, std::abs(part.volume_error()));
  return largest;
}

double MeshReport::lost_volume() const {
  double lost = 0;
  for (const Part& part : parts) lost = std::max(lost, -part.volume_error());
  return lost;
}

double MeshReport::largest_gap() const { return std::max(surface_to_mesh.largest, mesh_to_surface.largest); }

double shape_of(const MeshReport& report) {
  const Quality& quality = report.quality;
  return std::min({quality.min_dihedral / quality_gate.min_dihedral,
                   quality.smallest_altitude_ratio / quality_gate.smallest_altitude_ratio,
                   report.time_step_star / quality_gate.time_step_star});
}

bool MeshReport::has_good_shapes() const { return shape_of(*this) >= 1; }

bool MeshReport::passes() const {
  return missing_labels() == 0 && lost_volume() <= quality_gate.lost_volume &&
         largest_gap() <= quality_gate.gap * longest_edge && has_good_shapes();
}

void measure(const TetMesh& mesh, const Model& model, const MeshOptions& options, MeshReport& report) {
  report.vertices = mesh.vertex_count();
  report.tets = mesh.tet_count();
  report.quality = mesh_quality(mesh);
  report.surface_volume = model.total_volume();
  report.volume_error = 100 * (report.quality.volume / report.surface_volume - 1);
  report.mean_edge = report.quality.mean_edge;
  report.time_step = rest_time_step(mesh, {options.lambda, options.mu, options.density});
  const double wave_speed = std::sqrt((options.lambda + 2 * options.mu) / options.density);
  const double edge = report.shortest_edge < report.edge ? report.shortest_edge
                                                         : regular_edge(report.quality.volume / report.tets);
  report.time_step_star = report.time_step * wave_speed / edge;
  const double poisson_ratio = options.lambda / (2 * (options.lambda + options.mu));
  report.bottleneck = slowest_vertex(mesh, {.edge = edge, .poisson_ratio = poisson_ratio});
  measure_faces(mesh, report);
  measure_parts(mesh, model, options, report);
  warn_of_volume("the mesh's volume", report.volume_error, "choose a shorter --edge", report);
}

}  // namespace lobe::meshing
