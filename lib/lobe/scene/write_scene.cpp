#include "lobe/scene/write_scene.h"

#include "lobe/scene/boundary_keys.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/region_keys.h"
#include "lobe/scene/scene_document.h"
#include "lobe/scene/selector_keys.h"
#include "lobe/scene/time_keys.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

using nlohmann::ordered_json;

std::string utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

void add_where(ordered_json& entry, const std::optional<Selector>& where) {
  if (where) entry["where"] = keys::write_value(*where);
}

struct FibreWriter {
  ordered_json operator()(const FibreDirection& f) const { return {{"direction", vector_json(f.direction)}}; }
  ordered_json operator()(const FibreArray&) const { return {{"array", "fibre"}}; }
  ordered_json operator()(const FibreHarmonic& f) const {
    return {{"harmonic", {{"from", keys::write_value(f.from)}, {"to", keys::write_value(f.to)}}}};
  }
  ordered_json operator()(const FibreAround& f) const {
    return {{"axis", {{"point", vector_json(f.point)}, {"direction", vector_json(f.axis)}}}};
  }
};

ordered_json write_quaternion(const Eigen::Vector4d& q) { return {q[0], q[1], q[2], q[3]}; }

ordered_json write(const Material& material) {
  ordered_json entry = {{"name", material.name}};
  if (const auto& constants = material.transverse) {
    entry["young_modulus_along"] = constants->young_along;
    entry["young_modulus_across"] = constants->young_across;
    entry["poisson_ratio_along"] = constants->poisson_along;
    entry["poisson_ratio_across"] = constants->poisson_across;
    entry["shear_modulus_along"] = constants->shear_along;
  } else {
    entry["lame_lambda"] = material.lame_lambda;
    entry["lame_mu"] = material.lame_mu;
  }
  entry["density"] = material.density;
  entry["fracture_energy"] = material.fracture_energy;
  if (material.nodal_pressure) entry["nodal_pressure"] = *material.nodal_pressure;
  const LawRow& law = law_rows[std::size_t(material.law)];
  entry["law"] = law.name;
  for (std::size_t i = 0; i < law.keys.size(); ++i)
    if (law.keys[i]) entry[law.keys[i]] = material.further[i];
  if (has_families(material.law)) {
    entry["holzapfel_angle"] = material.fibre_angle;
    if (material.fibre_plane != std::array<double, 3>{}) entry["holzapfel_plane"] = material.fibre_plane;
  }
  for (const PronyTerm& term : material.viscosity)
    if (term.time > 0)
      entry["viscosity"].push_back({{"shear", term.shear}, {"bulk", term.bulk}, {"time", term.time}});
  if (material.element)
    entry["element"] = *material.element == ElementType::edge_smoothed ? "edge-smoothed" : "tetrahedron";
  if (material.fibre) entry["fibre"] = std::visit(FibreWriter{}, *material.fibre);
  add_where(entry, material.where);
  return entry;
}

void add_hold_by(ordered_json& entry, HoldBy by) {
  if (by != HoldBy::vertices) entry["hold_by"] = hold_by_names[std::size_t(by)];
}

ordered_json write(const Boundary& boundary) {
  static constexpr const char* kinds[] = {"fix", "displacement", "traction", "force", "pressure"};
  if (boundary.kind == Boundary::Kind::pressure)
    return {{"pressure", boundary.pressure}, {"where", keys::write_value(boundary.where)}};
  ordered_json value =
      boundary.kind == Boundary::Kind::fix ? ordered_json(true) : vector_json(boundary.value);
  for (std::size_t i = 0; i < 3; ++i)
    if (boundary.kind == Boundary::Kind::displacement && !boundary.axes[i]) value[i] = nullptr;
  ordered_json entry = {{kinds[static_cast<int>(boundary.kind)], value}};
  add_hold_by(entry, boundary.hold_by);
  entry["where"] = keys::write_value(boundary.where);
  return entry;
}

ordered_json write(const Tool& tool) {
  ordered_json path = ordered_json::array();
  for (const PathPoint& row : tool.path)
    path.push_back({row.time, row.position[0], row.position[1], row.position[2]});
  ordered_json entry = {{"name", tool.name}, {"type", tool.type}};
  add_where(entry, tool.where);
  add_hold_by(entry, tool.hold_by);
  entry["path"] = path;
  kind_of(tool).write(tool, entry);
  return entry;
}

template <class Entry>
ordered_json entries(const std::vector<Entry>& list) {
  ordered_json array = ordered_json::array();
  for (const Entry& entry : list) array.push_back(write(entry));
  return array;
}

ordered_json write_contact(const Scene& scene) {
  const ContactSetup& contact = scene.contact;
  ordered_json entry = {{"self", contact.self}, {"friction", contact.friction}, {"damping", contact.damping}};
  entry["obstacles"] = ordered_json::array();
  for (std::size_t i = 0; i < contact.obstacles.size(); ++i) {
    const ObstacleSetup& obstacle = contact.obstacles[i];
    entry["obstacles"].push_back({{"name", obstacle.name},
                                  {"shape", write_shape(obstacle.shape, scene.obstacle_files[i])},
                                  {"position", vector_json(obstacle.position)},
                                  {"orientation", write_quaternion(obstacle.orientation)},
                                  {"friction", obstacle.friction}});
  }
  return entry;
}

}  // namespace

ordered_json write_document(const Scene& scene) {
  static constexpr const char* pieces[] = {"fall", "vanish", "stay"};
  ordered_json document;
  document["name"] = scene.name;
  if (scene.bodies.empty()) {
    document["mesh"] = utf8(scene.mesh);
    document["mesh_scale"] = scene.mesh_scale;
  } else {
    document["bodies"] = keys::write_value(scene.bodies);
  }
  document["materials"] = entries(scene.materials);
  document["volume_penalty"] = scene.volume_penalty;
  document["guard_below"] = scene.guard_below;
  if (scene.auto_regions)
    document["regions"] = {{"auto", keys::write_value(*scene.auto_regions)}};
  else
    document["regions"] = keys::write_value(scene.regions);
  document["boundary"] = entries(scene.boundary);
  document["gravity"] = vector_json(scene.gravity);
  document["tools"] = entries(scene.tools);
  document["threads"] = keys::write_value(scene.threads);
  document["attachments"] = keys::write_value(scene.attachments);
  document["contact"] = write_contact(scene);
  document["loose_pieces"] = pieces[static_cast<int>(scene.loose_pieces)];
  document["skin"] = utf8(scene.skin);
  document["time"] = keys::write_value(scene.time);
  document["output"] = keys::write_value(scene.output);
  return document;
}

std::string to_json(const Scene& scene) {
  return write_document(scene).dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace lobe
