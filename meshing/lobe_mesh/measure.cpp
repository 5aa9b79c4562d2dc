// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/measure.h"

#include <algorithm>
#include <cmath>

#include "lobe/sim/rest_time_step.h"
#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/relax.h"

namespace lobe::meshing {
namespace {

void warn_of_volume(const std::string& whose, double error, const std::string& remedy, MeshReport& report) {
  if (std::abs(error) <= 5) return;
  report.warnings.push_back(whose + " differs from the input's by " + rounded(std::round(10 * error) / 10) +
                            " %: " + remedy);
}

void measure_parts(const TetMesh& mesh, const Model& model, MeshReport& report) {
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
    const std::string remedy = "choose a shorter edge for it (--label-edge " + label + "=EDGE)";
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

double MeshReport::largest_gap() const { return std::max(surface_to_mesh.largest, mesh_to_surface.largest); }

bool MeshReport::has_good_shapes() const {
  return quality.min_dihedral >= quality_gate.min_dihedral && time_step_star >= quality_gate.time_step_star &&
         quality.smallest_altitude_ratio >= quality_gate.smallest_altitude_ratio;
}

bool MeshReport::passes() const {
  return missing_labels() == 0 && largest_gap() <= quality_gate.gap * longest_edge && has_good_shapes();
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
  measure_parts(mesh, model, report);
  warn_of_volume("the mesh's volume", report.volume_error, "choose a shorter --edge", report);
}

}  // namespace lobe::meshing
