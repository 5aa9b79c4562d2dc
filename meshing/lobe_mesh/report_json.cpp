// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/report_json.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "lobe/text.h"
#include "lobe_mesh/check_options.h"

namespace lobe::meshing {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const RepairReport& repair) {
  Json json;
  json["steps"] = Json::array();
  for (const RepairStep& step : repair.steps) {
    json["steps"].push_back({{"name", step.name},
                             {"count", step.count},
                             {"message", step.message},
                             {"volume_before", step.volume_before},
                             {"volume_after", step.volume_after},
                             {"distance", step.distance}});
  }
  json["volume_before"] = repair.volume_before;
  json["volume_after"] = repair.volume_after;
  json["max_distance"] = repair.max_distance;
  json["pieces"] = repair.pieces;
  json["cavities"] = repair.cavities;
  return json;
}

const char* name_of(Mesher mesher) { return mesher == Mesher::cgal ? "cgal" : "tetgen"; }

Json as_json(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const Attempt& a) {
  Json json = {{"mesher", name_of(a.mesher)}, {"edge", a.edge}};
  if (!a.failure.empty()) {
    json["failure"] = a.failure;
  } else {
    json["min_dihedral"] = a.min_dihedral;
    json["time_step_star"] = a.time_step_star;
    json["largest_gap"] = a.largest_gap;
  }
  return json;
}

Json as_json(const SurfaceGap& gap) {
  return {{"mean", gap.mean},
          {"percentile_95", gap.percentile_95},
          {"largest", gap.largest},
          {"place", as_json(gap.place)}};
}

void add_quality(const Quality& q, Json& json) {
  json["volume"] = q.volume;
  json["min_dihedral"] = q.min_dihedral;
  json["median_min_dihedral"] = q.median_min_dihedral;
  json["max_dihedral"] = q.max_dihedral;
  json["dihedral_histogram_10_deg"] = q.dihedral_histogram;
  json["smallest_altitude"] = q.smallest_altitude;
  json["smallest_altitude_ratio"] = q.smallest_altitude_ratio;
  json["box"] = {{"min", as_json(q.box_min)}, {"max", as_json(q.box_max)}};
}

std::string position(const Vec3d& p) {
  return "(" + rounded(p.x()) + ", " + rounded(p.y()) + ", " + rounded(p.z()) + ") m";
}

}  // namespace

std::string in_json(const InputFile& input) {
  const Json json = {
      {"surface", input.file}, {"repair", as_json(*input.repair)}, {"warnings", input.repair->warnings}};
  return json.dump(2);
}

std::string in_json(const std::vector<InputFile>& inputs, const std::string& mesh_file,
                    const MeshOptions& options, const MeshReport& report) {
  Json json;
  const bool is_image = !inputs.front().repair;
  json[is_image ? "image" : "surface"] = inputs.front().file;
  json["mesh"] = mesh_file;
  json["mesher"] = name_of(report.mesher);
  json["edge"] = report.edge;
  json["shortest_edge"] = report.shortest_edge;
  json["mean_edge"] = report.mean_edge;
  json["vertices"] = report.vertices;
  json["tets"] = report.tets;
  json["boundary_faces"] = report.boundary_faces;
  add_quality(report.quality, json);
  json["surface_volume"] = report.surface_volume;
  json["volume_error_percent"] = report.volume_error;
  json["material"] = {{"lame_lambda", options.lambda}, {"lame_mu", options.mu}, {"density", options.density}};
  json["time_step"] = report.time_step;
  json["time_step_star"] = report.time_step_star;
  const Bottleneck& slowest = report.bottleneck;
  json["bottleneck"] = {{"vertex", slowest.vertex},
                        {"position", as_json(slowest.position)},
                        {"on_boundary", slowest.on_boundary},
                        {"tets", slowest.tets}};
  json["surface_to_mesh"] = as_json(report.surface_to_mesh);
  json["mesh_to_surface"] = as_json(report.mesh_to_surface);
  if (report.keeping_edge > 0) json["keeping_edge"] = report.keeping_edge;
  json["passes"] = report.passes();
  for (const Attempt& attempt : report.attempts) json["attempts"].push_back(as_json(attempt));
  for (const Phase& phase : report.phases) json["seconds"][phase.name] = phase.seconds;
  if (is_image)
    json["smoothing"] = options.smoothing;
  else
    json["repair"] = as_json(*inputs.front().repair);
  json["warnings"] = Json::array();
  for (std::size_t k = 0; k < report.parts.size(); ++k) {
    const MeshReport::Part& part = report.parts[k];
    json["parts"].push_back({{"label", part.label},
                             {"tets", part.tets},
                             {"volume", part.volume},
                             {"surface_volume", part.surface_volume}});
    if (is_image) continue;
    json["parts"].back()["surface"] = inputs[k].file;
    json["parts"].back()["repair"] = as_json(*inputs[k].repair);
    for (const std::string& warning : inputs[k].repair->warnings) json["warnings"].push_back(warning);
  }
  for (const std::string& warning : report.warnings) json["warnings"].push_back(warning);
  return json.dump(2);
}

std::string in_words(const MeshReport& report) {
  const Quality& q = report.quality;
  std::ostringstream text;
  for (const Attempt& a : report.attempts) {
    text << "try with " << name_of(a.mesher) << ", edge " << rounded(a.edge) << " m: ";
    if (!a.failure.empty())
      text << a.failure << "\n";
    else
      text << "dt* " << rounded(a.time_step_star) << ", smallest dihedral angle " << rounded(a.min_dihedral)
           << "°, at most " << rounded(a.largest_gap) << " m between surface and mesh\n";
  }
  text << report.vertices << " vertices, " << report.tets << " tetrahedra of mean edge " << report.mean_edge
       << " m, with the mean volume of regular ones of " << regular_edge(q.volume / report.tets)
       << " m (asked: " << report.edge << ")\n";
  if (report.parts.size() > 1) {
    for (const MeshReport::Part& part : report.parts)
      text << "label " << part.label << ": " << part.tets << " tetrahedra, " << part.volume << " m³, "
           << rounded(part.volume_error()) << " % from the input's\n";
  }
  text << "dihedral angles " << q.min_dihedral << " … " << q.max_dihedral << "°, median of the smallest "
       << q.median_min_dihedral << "°; smallest altitude " << q.smallest_altitude << " m\n";
  text << "volume " << q.volume << " m³, " << report.volume_error << " % from the input's\n";
  text << "from the surface to the mesh " << rounded(report.surface_to_mesh.mean)
       << " m in the mean, at most " << rounded(report.surface_to_mesh.largest) << " m at "
       << position(report.surface_to_mesh.place) << "; back " << rounded(report.mesh_to_surface.mean)
       << " m, at most " << rounded(report.mesh_to_surface.largest) << " m\n";
  text << "stable time step " << report.time_step << " s (dt* " << report.time_step_star
       << "), bounded near vertex " << report.bottleneck.vertex << " at "
       << position(report.bottleneck.position) << ", "
       << (report.bottleneck.on_boundary ? "on the surface" : "inside") << ", of " << report.bottleneck.tets
       << " tetrahedra\n";
  for (const Phase& phase : report.phases) text << phase.name << " " << phase.seconds << " s  ";
  text << "\n";
  return text.str();
}

}  // namespace lobe::meshing
