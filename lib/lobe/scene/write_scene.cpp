#include "lobe/scene/write_scene.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/tool_kinds.h"

#include <nlohmann/json.hpp>

#include "lobe/scene/json_text.h"

namespace lobe {
namespace {

using nlohmann::ordered_json;

std::string utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

ordered_json selector(const Selector& value);

ordered_json parts(const std::vector<Selector>& selectors) {
  ordered_json array = ordered_json::array();
  for (const Selector& part : selectors) array.push_back(selector(part));
  return array;
}

ordered_json write(const SelectAll&) { return {{"all", true}}; }
ordered_json write(const SelectBox& box) {
  return {{"box", {{"min", vector_json(box.min)}, {"max", vector_json(box.max)}}}};
}
ordered_json write(const SelectSphere& sphere) {
  return {{"sphere", {{"center", vector_json(sphere.center)}, {"radius", sphere.radius}}}};
}
ordered_json write(const SelectPlane& plane) {
  ordered_json object = {{"point", vector_json(plane.point)}, {"normal", vector_json(plane.normal)}};
  if (plane.side == SelectPlane::Side::within) {
    object["within"] = plane.within;
  } else {
    object["side"] = plane.side == SelectPlane::Side::above ? "above" : "below";
  }
  return {{"plane", object}};
}
ordered_json write(const SelectNearest& nearest) {
  return {{"nearest", {{"point", vector_json(nearest.point)}, {"count", nearest.count}}}};
}
ordered_json write(const SelectLabel& label) {
  ordered_json labels = label.labels;
  for (const std::string& name : label.names) labels.push_back(name);
  return {{"label", labels}};
}
ordered_json write(const SelectSurface& select) { return {{"surface", select.names}}; }
ordered_json write(const SelectBody& select) { return {{"body", select.names}}; }
ordered_json write(const SelectPatch& patch) {
  return {{"patch", {{"point", vector_json(patch.point)}, {"angle", patch.angle}}}};
}
ordered_json write(const SelectVertices& select) { return {{"vertices", select.vertices}}; }
ordered_json write(const SelectTetrahedra& select) { return {{"tetrahedra", select.tetrahedra}}; }
ordered_json write(const SelectAnyOf& any) { return {{"any_of", parts(any.parts)}}; }
ordered_json write(const SelectAllOf& all) { return {{"all_of", parts(all.parts)}}; }
ordered_json write(const SelectNot& negated) {
  return {{"not", negated.part.size() == 1 ? selector(negated.part[0]) : ordered_json(nullptr)}};
}

ordered_json selector(const Selector& value) {
  return std::visit([](const auto& select) { return write(select); }, value.value);
}

void add_where(ordered_json& entry, const std::optional<Selector>& where) {
  if (where) entry["where"] = selector(*where);
}

struct FibreWriter {
  ordered_json operator()(const FibreDirection& f) const { return {{"direction", vector_json(f.direction)}}; }
  ordered_json operator()(const FibreArray&) const { return {{"array", "fibre"}}; }
  ordered_json operator()(const FibreHarmonic& f) const {
    return {{"harmonic", {{"from", selector(f.from)}, {"to", selector(f.to)}}}};
  }
  ordered_json operator()(const FibreAround& f) const {
    return {{"axis", {{"point", vector_json(f.point)}, {"direction", vector_json(f.axis)}}}};
  }
};

ordered_json write_quaternion(const Eigen::Vector4d& q) { return {q[0], q[1], q[2], q[3]}; }

ordered_json write(const SceneBody& body) {
  ordered_json entry = {{"name", body.name},
                        {"mesh", utf8(body.mesh)},
                        {"mesh_scale", body.mesh_scale},
                        {"position", vector_json(body.position)},
                        {"orientation", write_quaternion(body.orientation)}};
  if (body.carries != Carries::nothing) entry["carries"] = carries_names[std::size_t(body.carries)];
  return entry;
}

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
  if (material.element)
    entry["element"] = *material.element == ElementType::edge_smoothed ? "edge-smoothed" : "tetrahedron";
  if (material.fibre) entry["fibre"] = std::visit(FibreWriter{}, *material.fibre);
  add_where(entry, material.where);
  return entry;
}

ordered_json write(const Region& region) {
  ordered_json entry = {{"name", region.name}, {"model", name(region.model)}};
  if (region.frame == RegionFrame::corotated) entry["frame"] = "corotated";
  if (region.cell > 0) entry["cell"] = region.cell;
  if (region.tolerance > 0) entry["tolerance"] = region.tolerance;
  add_where(entry, region.where);
  return entry;
}

ordered_json write(const AutoRegions& regions) {
  ordered_json gestures = ordered_json::array();
  for (const SceneGesture& gesture : regions.gestures)
    gestures.push_back({{"name", gesture.name},
                        {"where", selector(gesture.where)},
                        {gesture.is_force ? "force" : "displacement", vector_json(gesture.value)}});
  return {{"auto",
           {{"tolerance", regions.tolerance},
            {"precomputed", regions.precomputed},
            {"reduced", regions.reduced},
            {"correct", regions.correct},
            {"gestures", gestures}}}};
}

void add_hold_by(ordered_json& entry, HoldBy by) {
  if (by != HoldBy::vertices) entry["hold_by"] = hold_by_names[std::size_t(by)];
}

ordered_json write(const Boundary& boundary) {
  static constexpr const char* kinds[] = {"fix", "displacement", "traction", "force", "pressure"};
  if (boundary.kind == Boundary::Kind::pressure)
    return {{"pressure", boundary.pressure}, {"where", selector(boundary.where)}};
  ordered_json value =
      boundary.kind == Boundary::Kind::fix ? ordered_json(true) : vector_json(boundary.value);
  for (std::size_t i = 0; i < 3; ++i)
    if (boundary.kind == Boundary::Kind::displacement && !boundary.axes[i]) value[i] = nullptr;
  ordered_json entry = {{kinds[static_cast<int>(boundary.kind)], value}};
  add_hold_by(entry, boundary.hold_by);
  entry["where"] = selector(boundary.where);
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

ordered_json write(const SceneStitch& stitch) {
  ordered_json through = ordered_json::array(), ties = ordered_json::array();
  for (const Vec3d& point : stitch.through) through.push_back(vector_json(point));
  for (const SceneTie& tie : stitch.ties) {
    ordered_json& entry =
        ties.emplace_back(ordered_json{{"at", tie.at}, {"tighten", tie.tighten}, {"over", tie.over}});
    if (tie.between) entry["between"] = *tie.between;
  }
  return {{"through", through}, {"at", stitch.at}, {"tie", ties}};
}

ordered_json write(const SceneThread& thread) {
  ordered_json entry = {{"name", thread.name},
                        {"stiffness", thread.material.stiffness},
                        {"friction", thread.material.friction}};
  if (thread.material.strength < unlimited) entry["strength"] = thread.material.strength;
  if (thread.material.holds < unlimited) entry["holds"] = thread.material.holds;
  entry["stitches"] = ordered_json::array();
  for (const SceneStitch& stitch : thread.stitches) entry["stitches"].push_back(write(stitch));
  return entry;
}

ordered_json write(const SceneBed& bed) {
  ordered_json entry = {{"from", selector(bed.from)}};
  if (bed.to)
    entry["to"] = selector(*bed.to);
  else
    entry["to_world"] = true;
  if (bed.to) entry["within"] = bed.within;
  if (bed.spacing > 0) entry["spacing"] = bed.spacing;
  entry["stiffness"] = bed.stiffness;
  if (bed.fracture_energy) entry["fracture_energy"] = *bed.fracture_energy;
  return {{"bed", entry}};
}

ordered_json write(const SceneLigament& ligament) {
  ordered_json entry = {{"from", vector_json(ligament.from)},
                        {ligament.ends_in_world ? "to_world" : "to", vector_json(ligament.to)},
                        {"stiffness", ligament.stiffness},
                        {"slack", ligament.slack}};
  if (ligament.strength) entry["strength"] = *ligament.strength;
  return {{"ligament", entry}};
}

ordered_json write(const SceneAttachment& attachment) {
  ordered_json entry = {{"name", attachment.name}, {"softening", attachment.softening}};
  entry.update(std::visit([](const auto& what) { return write(what); }, attachment.what));
  return entry;
}

template <class Entry>
ordered_json entries(const std::vector<Entry>& list) {
  ordered_json array = ordered_json::array();
  for (const Entry& entry : list) array.push_back(write(entry));
  return array;
}

ordered_json write(const Time& time) {
  ordered_json entry = {{"duration", time.duration},
                        {"frame", time.frame},
                        {"damping", time.damping},
                        {"safety", time.safety},
                        {"cut_step", time.cut_step},
                        {"selective_mass", time.selective_mass},
                        {"ramp", time.ramp},
                        {"load_ramp", time.load_ramp},
                        {"precision", time.precision == Precision::single_precision ? "single" : "double"},
                        {"integrator", name(time.integrator)},
                        {"step", time.step},
                        {"spectral_radius", time.spectral_radius}};
  if (time.sleep) entry["sleep"] = *time.sleep;
  return entry;
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

std::string to_json(const Scene& scene) {
  static constexpr const char* pieces[] = {"fall", "vanish", "stay"};
  ordered_json document;
  document["name"] = scene.name;
  if (scene.bodies.empty()) {
    document["mesh"] = utf8(scene.mesh);
    document["mesh_scale"] = scene.mesh_scale;
  } else {
    document["bodies"] = entries(scene.bodies);
  }
  document["materials"] = entries(scene.materials);
  document["volume_penalty"] = scene.volume_penalty;
  document["guard_below"] = scene.guard_below;
  document["regions"] = scene.auto_regions ? write(*scene.auto_regions) : entries(scene.regions);
  document["boundary"] = entries(scene.boundary);
  document["gravity"] = vector_json(scene.gravity);
  document["tools"] = entries(scene.tools);
  document["threads"] = entries(scene.threads);
  document["attachments"] = entries(scene.attachments);
  document["contact"] = write_contact(scene);
  document["loose_pieces"] = pieces[static_cast<int>(scene.loose_pieces)];
  document["skin"] = utf8(scene.skin);
  document["time"] = write(scene.time);
  document["output"] = {{"every", scene.output.every}, {"pictures", scene.output.pictures}};
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace lobe
