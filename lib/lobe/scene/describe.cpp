#include "lobe/scene/describe.h"

#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "lobe/scene/pace_text.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/summary.h"
#include "lobe/scene/tool_kinds.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using nlohmann::ordered_json;

std::string triple(const ordered_json& v) {
  return "[" + rounded(v[0]) + ", " + rounded(v[1]) + ", " + rounded(v[2]) + "]";
}

double norm(const ordered_json& v) { return Vec3d(v[0], v[1], v[2]).norm(); }

void print_bodies(std::ostream& out, const ordered_json& summary) {
  if (!summary.contains("bodies")) return;
  for (const ordered_json& body : summary["bodies"])
    out << "body       " << body["name"].get<std::string>() << ": " << body["file"].get<std::string>() << ", "
        << body["tetrahedra"] << " tetrahedra, " << rounded(body["volume_m3"]) << " m³, "
        << rounded(body["mass_kg"]) << " kg, " << triple(body["box_min_m"]) << " to "
        << triple(body["box_max_m"]) << " m"
        << (body.contains("carries") ? ", carries " + body["carries"].get<std::string>() : "") << "\n";
}

void print_regions(std::ostream& out, const ordered_json& regions) {
  out << "regions   ";
  if (regions.contains("auto")) {
    const ordered_json& chosen = regions["auto"];
    out << " automatic, for an error of " << rounded(100 * chosen["tolerance"].get<double>()) << " % in ";
    if (chosen["gestures"].empty()) out << "pulls on the free surface";
    for (std::size_t i = 0; i < chosen["gestures"].size(); ++i)
      out << (i > 0 ? ", " : "") << chosen["gestures"][i].get<std::string>();
    out << "\n";
    return;
  }
  const char* separator = " ";
  for (const auto& [name, count] : regions.items()) {
    out << separator << name << " " << count;
    separator = ", ";
  }
  out << " tetrahedra\n";
}

void print_fibre(std::ostream& out, const ordered_json& fibre) {
  out << "fibres     E " << rounded(fibre["young_modulus_along_Pa"]) << " Pa along, "
      << rounded(fibre["young_modulus_across_Pa"]) << " Pa across, ratio " << rounded(fibre["young_ratio"])
      << ", of shear " << rounded(fibre["shear_ratio"]) << "; waves "
      << rounded(fibre["wave_speed_along_m_s"]) << " m/s along, " << rounded(fibre["wave_speed_across_m_s"])
      << " across, of shear " << rounded(fibre["shear_wave_speed_along_m_s"]) << " and "
      << rounded(fibre["shear_wave_speed_across_m_s"]) << "\n";
}

void print_viscosity(std::ostream& out, const ordered_json& material) {
  double shear = 0, bulk = 0;  // shares that relax
  out << ", relaxing in";
  const char* between = " ";
  for (const ordered_json& term : material["viscosity"]) {
    out << between << rounded(term["time_s"]);
    between = ", ";
    shear += term["shear"].get<double>();
    bulk += term["bulk"].get<double>();
  }
  out << " s";
  for (const auto& [what, share] : {std::pair("shear", shear), std::pair("bulk", bulk)})
    if (share > 0) out << ", in " << what << " at once " << rounded(1 / (1 - share)) << " times as stiff";
}

void print_materials(std::ostream& out, const ordered_json& materials) {
  for (const ordered_json& m : materials) {
    out << "material   " << m["name"].get<std::string>() << ": " << m["tetrahedra"] << " tetrahedra, E "
        << rounded(m["young_modulus_Pa"]) << " Pa, nu " << rounded(m["poisson_ratio"]) << ", density "
        << rounded(m["density_kg_m3"]) << " kg/m³, waves " << rounded(m["wave_speed_m_s"])
        << " m/s, sag under gravity about " << rounded(m["expected_sag_m"]) << " m";
    if (m["nodal_pressure"] > 0) out << ", nodal pressure " << rounded(m["nodal_pressure"]);
    if (m.contains("fracture_energy_J_m2"))
      out << ", " << rounded(m["fracture_energy_J_m2"]) << " J/m² to cut";
    if (m.contains("law")) out << ", " << m["law"].get<std::string>();
    if (m.contains("element")) out << ", edge-smoothed";
    if (m.contains("viscosity")) print_viscosity(out, m);
    out << "\n";
    if (m.contains("fibre")) print_fibre(out, m["fibre"]);
  }
}

void print_loads(std::ostream& out, const ordered_json& summary) {
  const ordered_json& loads = summary["loads"];
  out << "held       " << summary["fixed_vertices"] << " vertices fixed, ";
  if (summary["sliding_vertices"] != 0) out << summary["sliding_vertices"] << " sliding, ";
  out << summary["moved_vertices"] << " moved\n";
  out << "loads      force " << triple(loads["force_N"]) << " N, traction "
      << triple(loads["traction_force_N"]) << " N on " << rounded(loads["loaded_area_m2"]) << " m²\n";
  if (loads["area_under_pressure_m2"] > 0)
    out << "           pressure on " << rounded(loads["area_under_pressure_m2"]) << " m², at rest "
        << triple(loads["pressure_force_N"]) << " N in all\n";
  out << "weight     " << rounded(norm(loads["weight_N"])) << " N, mass " << rounded(loads["mass_kg"])
      << " kg\n";
}

void print_tools(std::ostream& out, const ordered_json& tools) {
  for (const ordered_json& tool : tools) {
    out << "tool       " << tool["name"].get<std::string>() << ": " << tool["type"].get<std::string>() << ", "
        << rounded(tool["from_s"]) << " to " << rounded(tool["to_s"]) << " s, " << describe_tool(tool)
        << "\n";
  }
}

}  // namespace

std::string describe_json(const Scene& scene, const Resolved& resolved) {
  return summarise(scene, resolved).dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::string describe(const Scene& scene, const Resolved& resolved) {
  const ordered_json summary = summarise(scene, resolved);
  const ordered_json& mesh = summary["mesh"];
  std::ostringstream out;
  if (!scene.name.empty()) out << "scene      " << scene.name << "\n";
  const std::string file = summary.contains("bodies") ? counted(summary["bodies"].size(), "body", "bodies")
                                                      : mesh["file"].get<std::string>();
  out << "mesh       " << file << ": " << mesh["vertices"] << " vertices, " << mesh["tetrahedra"]
      << " tetrahedra, " << rounded(mesh["volume_m3"]) << " m³, " << triple(mesh["box_min_m"]) << " to "
      << triple(mesh["box_max_m"]) << " m\n";
  print_bodies(out, summary);
  print_materials(out, summary["materials"]);
  out << "volume     penalty " << rounded(summary["volume_penalty_Pa"]) << " Pa";
  if (const double below = summary["guard_below"]; below > 0) out << ", guard below " << rounded(below);
  out << "\n";
  print_regions(out, summary["regions"]);
  print_loads(out, summary);
  print_tools(out, summary["tools"]);
  for_each_kind(scene, [&]<class Force>(const std::vector<Force>& all) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      Force::print(summary[Force::key][i], out);
      out << "\n";
    }
  });
  if (summary.contains("pace")) out << pace_lines(summary["pace"]);
  out << "run        " << rounded(scene.time.duration) << " s in frames of " << rounded(scene.time.frame)
      << " s, " << summary["integrator"].get<std::string>() << ", " << summary["precision"].get<std::string>()
      << " precision";
  if (scene.time.own_steps) out << ", own steps";
  if (scene.time.selective_mass > 1) out << ", selective masses of degree " << scene.time.selective_mass;
  out << "\n";
  out << "output     " << rounded(summary["vtu_frames"]) << " VTU frames, " << summary["pictures"]
      << " pictures\n";
  for (const std::string& warning : resolved.warnings) out << "warning    " << warning << "\n";
  return out.str();
}

}  // namespace lobe
