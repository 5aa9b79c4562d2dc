#include "lobe/scene/summary.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "lobe/diagnostics/body_figures.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/pace_text.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/tool_kinds.h"
#include "lobe/scene/unit_checks.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using nlohmann::ordered_json;

ordered_json summarise_mesh(const Scene& scene, const TetMesh& mesh) {
  std::map<std::string, Index> labels;
  for (const int label : mesh.labels) ++labels[std::to_string(label)];
  return {{"file", scene.mesh.string()},
          {"vertices", mesh.vertex_count()},
          {"tetrahedra", mesh.tet_count()},
          {"labels", labels},
          {"volume_m3", total_volume(mesh)},
          {"box_min_m", vector_json(bounding_box(mesh).min)},
          {"box_max_m", vector_json(bounding_box(mesh).max)}};
}

// Each of several bodies: what it is made of, and where it begins.
ordered_json summarise_bodies(const Scene& scene, const Setup& setup) {
  const Mat3X<double> at_rest = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  ordered_json list = ordered_json::array();
  for (const BodyFigures& body : body_figures(Elements(setup), at_rest, at_rest)) {
    const std::size_t at = list.size();
    const Box box = bounding_box(tets_of_body(setup.mesh, int(at)));
    list.push_back({{"name", body.name},
                    {"file", at < scene.bodies.size() ? scene.bodies[at].mesh.string() : ""},
                    {"tetrahedra", body.tets},
                    {"volume_m3", body.volume},
                    {"mass_kg", body.mass},
                    {"box_min_m", vector_json(box.min)},
                    {"box_max_m", vector_json(box.max)}});
    if (at < scene.bodies.size() && scene.bodies[at].carries != Carries::nothing)
      list.back()["carries"] = carries_names[std::size_t(scene.bodies[at].carries)];
  }
  return list;
}

ordered_json summarise_fibre(const Elastic& m) {
  const TransverseConstants c = transverse_constants(m);
  return {{"young_modulus_along_Pa", c.young_along},
          {"young_modulus_across_Pa", c.young_across},
          {"young_ratio", c.young_along / c.young_across},
          {"shear_ratio", shear_along(m) / m.mu},
          {"wave_speed_along_m_s", std::sqrt(stiffness_along(m) / m.density)},
          {"wave_speed_across_m_s", std::sqrt(stiffness_across(m) / m.density)},
          {"shear_wave_speed_along_m_s", std::sqrt(shear_along(m) / m.density)},
          {"shear_wave_speed_across_m_s", std::sqrt(m.mu / m.density)}};
}

ordered_json summarise_materials(const Scene& scene, const Setup& setup) {
  std::vector<Index> counts(setup.materials.size(), 0);
  for (const std::uint16_t material : setup.material_of) ++counts[material];
  const double g = scene.gravity.norm() > 0 ? scene.gravity.norm() : standard_gravity;
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < setup.materials.size(); ++i) {
    const Elastic& m = setup.materials[i];
    const Elastic sudden = m.at_once();
    ordered_json& entry =
        list.emplace_back(ordered_json{{"name", scene.materials[i].name},
                                       {"tetrahedra", counts[i]},
                                       {"young_modulus_Pa", young_modulus(m.lambda, m.mu)},
                                       {"poisson_ratio", poisson_ratio(m.lambda, m.mu)},
                                       {"density_kg_m3", m.density},
                                       {"nodal_pressure", m.nodal_pressure},
                                       {"wave_speed_m_s", wave_speed(sudden.lambda, sudden.mu, m.density)},
                                       {"expected_sag_m", expected_sag(m, g, box_diagonal(setup.mesh))}});
    if (m.fracture_energy > 0) entry["fracture_energy_J_m2"] = m.fracture_energy;
    if (m.law != MaterialLaw::svk) entry["law"] = law_rows[std::size_t(m.law)].name;
    for (const PronyTerm& term : m.prony_series())
      entry["viscosity"].push_back({{"shear", term.shear}, {"bulk", term.bulk}, {"time_s", term.time}});
    if (m.is_smoothed()) entry["element"] = "edge-smoothed";
    if (m.fibre.any()) entry["fibre"] = summarise_fibre(m);
  }
  return list;
}

ordered_json summarise_regions(const Scene& scene, const Resolved& resolved) {
  const Setup& setup = resolved.setup;
  ordered_json counts;
  if (scene.auto_regions && !resolved.proposal) {
    ordered_json names = ordered_json::array();
    for (const Gesture& gesture : resolved.gestures) names.push_back(gesture.name);
    return {{"auto", {{"tolerance", scene.auto_regions->tolerance}, {"gestures", names}}}};
  }
  for (const char* model : region_model_names) counts[model] = 0;
  for (const RegionModel model : setup.region_of) {
    auto& count = counts[name(model)];
    count = count.get<Index>() + 1;
  }
  return counts;
}

template <class Load>
Vec3d area_under(const TetMesh& mesh, const Load& load) {
  const auto corner = [&](int i) -> Vec3d {
    return mesh.points.col(mesh.tets(face_corners[load.face][i], load.tet));
  };
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

ordered_json summarise_loads(const Setup& setup) {
  Vec3d forces = Vec3d::Zero(), tractions = Vec3d::Zero();
  double area = 0, mass = 0;
  for (const VertexLoad& load : setup.vertex_loads) forces += load.force;
  for (const FaceLoad& load : setup.face_loads) {
    const double face = area_under(setup.mesh, load).norm();
    area += face;
    tractions += face * load.traction;
  }
  double pressed = 0;
  Vec3d pressures = Vec3d::Zero();
  for (const FacePressure& load : setup.pressures) {
    const Vec3d face = area_under(setup.mesh, load);
    pressed += face.norm();
    pressures -= load.pressure * face;
  }
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Elastic& m = setup.materials[setup.material_of[static_cast<std::size_t>(t)]];
    mass += m.density * signed_volume(tet_points(setup.mesh, t));
  }
  return {{"force_N", vector_json(forces)},
          {"loaded_area_m2", area},
          {"traction_force_N", vector_json(tractions)},
          {"area_under_pressure_m2", pressed},
          {"pressure_force_N", vector_json(pressures)},
          {"mass_kg", mass},
          {"weight_N", vector_json(mass * setup.gravity)}};
}

ordered_json summarise_tools(const Scene& scene, const Setup& setup) {
  ordered_json list = ordered_json::array();
  std::map<std::string, std::size_t> count;  // of the tools of each kind so far
  for (const Tool& tool : scene.tools) {
    ordered_json entry = {{"name", tool.name()},
                          {"type", tool.type()},
                          {"from_s", tool.path().front().time},
                          {"to_s", tool.path().back().time}};
    summarise(setup, tool, count[tool.type()]++, entry);
    list.push_back(entry);
  }
  return list;
}

}  // namespace

ordered_json summarise(const Scene& scene, const Resolved& resolved) {
  const Setup& setup = resolved.setup;
  const auto count = [&](auto&& holds) {
    return std::count_if(setup.prescribed.begin(), setup.prescribed.end(), holds);
  };
  const auto moved = count([](const PrescribedVertex& p) { return !p.displacement.isZero(0); });
  const auto sliding =
      count([](const PrescribedVertex& p) { return p.displacement.isZero(0) && p.axes != all_axes; });
  ordered_json summary;
  summary["scene"] = scene.file.string();
  summary["name"] = scene.name;
  summary["mesh"] = summarise_mesh(scene, setup.mesh);
  if (setup.mesh.bodies.any()) summary["bodies"] = summarise_bodies(scene, setup);
  summary["materials"] = summarise_materials(scene, setup);
  summary["volume_penalty_Pa"] = setup.volume_penalty;
  summary["guard_below"] = setup.guard_below;
  summary["regions"] = summarise_regions(scene, resolved);
  summary["fixed_vertices"] = setup.prescribed.size() - static_cast<std::size_t>(moved + sliding);
  summary["sliding_vertices"] = sliding;
  summary["moved_vertices"] = moved;
  if (!setup.partly_held.empty()) summary["partly_held_vertices"] = setup.partly_held.size();
  summary["loads"] = summarise_loads(setup);
  summary["tools"] = summarise_tools(scene, setup);
  for_each_kind(scene, [&]<class Force>(const std::vector<Force>& all) {
    for (std::size_t i = 0; i < all.size(); ++i)
      summary[Force::key].push_back(all[i].template summary<ordered_json>(setup, i));
  });
  if (const auto pace = summarise_pace(scene, resolved); !pace.is_null()) summary["pace"] = pace;
  summary["duration_s"] = scene.time.duration;
  summary["frame_s"] = scene.time.frame;
  summary["precision"] = scene.in_double() ? "double" : "single";
  summary["integrator"] = name(scene.time.integrator);
  if (scene.time.selective_mass > 1) summary["selective_mass"] = scene.time.selective_mass;
  summary["vtu_frames"] =
      1 + std::floor(scene.time.duration / std::max(scene.output.every, scene.time.frame) + 1e-9);
  summary["pictures"] = scene.output.pictures.size();
  summary["warnings"] = resolved.warnings;
  return summary;
}

}  // namespace lobe
