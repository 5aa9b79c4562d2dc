// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/report_json.h"

#include <nlohmann/json.hpp>
#include <sstream>

namespace lobe::meshing {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const RepairReport& repair) {
  Json json;
  json["steps"] = Json::array();
  for (const RepairStep& step : repair.steps) {
    json["steps"].push_back({{"name", step.name}, {"count", step.count}, {"message", step.message}});
  }
  json["volume_before"] = repair.volume_before;
  json["volume_after"] = repair.volume_after;
  json["max_distance"] = repair.max_distance;
  json["pieces"] = repair.pieces;
  json["cavities"] = repair.cavities;
  return json;
}

}  // namespace

std::string in_json(const std::string& surface_file, const std::string& mesh_file, const MeshOptions& options,
                    const RepairReport& repair, const MeshReport& report) {
  const Quality& q = report.quality;
  Json json;
  json["surface"] = surface_file;
  json["mesh"] = mesh_file;
  json["mesher"] = options.mesher == Mesher::cgal ? "cgal" : "tetgen";
  json["edge"] = report.edge;
  json["mean_edge"] = report.mean_edge;
  json["vertices"] = report.vertices;
  json["tets"] = report.tets;
  json["boundary_faces"] = report.boundary_faces;
  json["volume"] = q.volume;
  json["surface_volume"] = report.surface_volume;
  json["volume_error_percent"] = report.volume_error;
  json["min_dihedral"] = q.min_dihedral;
  json["median_min_dihedral"] = q.median_min_dihedral;
  json["max_dihedral"] = q.max_dihedral;
  json["smallest_altitude"] = q.smallest_altitude;
  json["smallest_altitude_ratio"] = q.smallest_altitude_ratio;
  json["box"] = {{"min", {q.box_min.x(), q.box_min.y(), q.box_min.z()}},
                 {"max", {q.box_max.x(), q.box_max.y(), q.box_max.z()}}};
  json["material"] = {{"lame_lambda", options.lambda}, {"lame_mu", options.mu}, {"density", options.density}};
  json["time_step"] = report.time_step;
  json["time_step_star"] = report.time_step_star;
  for (const Phase& phase : report.phases) json["seconds"][phase.name] = phase.seconds;
  json["repair"] = as_json(repair);
  json["warnings"] = repair.warnings;
  for (const std::string& warning : report.warnings) json["warnings"].push_back(warning);
  return json.dump(2);
}

std::string in_words(const MeshReport& report) {
  const Quality& q = report.quality;
  std::ostringstream text;
  text << report.vertices << " vertices, " << report.tets << " tetrahedra of mean edge " << report.mean_edge
       << " m (asked: " << report.edge << ")\n";
  text << "dihedral angles " << q.min_dihedral << " … " << q.max_dihedral << "°, median of the smallest "
       << q.median_min_dihedral << "°; smallest altitude " << q.smallest_altitude << " m\n";
  text << "volume " << q.volume << " m³, " << report.volume_error << " % from the surface's\n";
  text << "stable time step " << report.time_step << " s (dt* " << report.time_step_star << ")\n";
  for (const Phase& phase : report.phases) text << phase.name << " " << phase.seconds << " s  ";
  text << "\n";
  return text.str();
}

}  // namespace lobe::meshing
