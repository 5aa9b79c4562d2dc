#include "lobe/scene/read_scene.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/fem/law_fault.h"
#include "lobe/scene/boundary_keys.h"
#include "lobe/scene/check_scene.h"
#include "lobe/scene/explain.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/region_keys.h"
#include "lobe/scene/scene_document.h"
#include "lobe/scene/selector_keys.h"
#include "lobe/scene/time_keys.h"
#include "lobe/scene/tissues.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

using nlohmann::json;

// Overwrites a default where the key is given.
template <class Value>
void read(const json& object, const char* key, Value& value) {
  if (object.contains(key)) value = object[key].template get<Value>();
}

void read_path(const json& object, const char* key, std::filesystem::path& path) {
  const std::string text = object.value(key, "");
  path = std::u8string(text.begin(), text.end());
}

void read_orientation(const json& object, Eigen::Vector4d& quaternion) {
  if (!object.contains("orientation")) return;
  for (int i = 0; i < 4; ++i) quaternion[i] = object["orientation"][std::size_t(i)].get<double>();
}

std::optional<Selector> read_where(const json& entry) {
  if (!entry.contains("where")) return std::nullopt;
  return keys::read_from<Selector>(entry["where"]);
}

FibreField read_fibre(const json& object) {
  if (object.contains("direction")) return FibreDirection{read_vector(object["direction"])};
  if (object.contains("array")) return FibreArray{};
  if (object.contains("axis"))
    return FibreAround{read_vector(object["axis"]["point"]), read_vector(object["axis"]["direction"])};
  const json& ends = object["harmonic"];
  return FibreHarmonic{keys::read_from<Selector>(ends["from"]), keys::read_from<Selector>(ends["to"])};
}

void read_transverse(const json& entry, Material& material) {
  material.transverse = {entry["young_modulus_along"], entry["young_modulus_across"],
                         entry["poisson_ratio_along"], entry["poisson_ratio_across"],
                         entry["shear_modulus_along"]};
}

void read_families(const json& entry, const std::string& pointer, Material& material) {
  const bool has_fibres = has_families(material.law);
  for (const char* key : {"holzapfel_angle", "holzapfel_plane"})
    if (entry.contains(key) && !has_fibres)
      throw InputError({{pointer + "/" + key, "is of \"law\": \"holzapfel\" alone"}});
  if (entry.contains("fibre")) {
    if (!has_fibres && !entry.contains("young_modulus_along"))
      throw InputError({{pointer + "/fibre",
                         "needs constants along and across fibres (young_modulus_along "
                         "and four more), or \"law\": \"holzapfel\""}});
    material.fibre = read_fibre(entry["fibre"]);
  } else if (has_fibres) {
    throw InputError({{pointer + "/fibre", "is missing: which way the fibres run"}});
  }
  read(entry, "holzapfel_angle", material.fibre_angle);
  if (!entry.contains("holzapfel_plane")) return;
  const Vec3d plane = read_vector(entry["holzapfel_plane"]);
  material.fibre_plane = {plane[0], plane[1], plane[2]};
}

void read_law(const json& entry, const std::string& pointer, Material& material) {
  const std::string wanted = entry.value("law", law_rows[0].name);
  for (int law = 0; law < law_count; ++law) {
    const LawRow& row = law_rows[law];
    if (row.name == wanted) material.law = MaterialLaw(law);
    for (std::size_t i = 0; i < row.keys.size(); ++i) {
      if (!row.keys[i] || !entry.contains(row.keys[i])) continue;
      if (row.name != wanted)
        throw InputError(
            {{pointer + "/" + row.keys[i], "is a modulus of \"law\": \"" + std::string(row.name) +
                                               "\", but the law is \"" + wanted + "\""}});
      material.further[i] = entry[row.keys[i]];
    }
  }
}

void read_viscosity(const json& entry, Material& material) {
  if (!entry.contains("viscosity")) return;
  std::size_t i = 0;
  for (const json& given : entry["viscosity"]) {  // at most as many, by the schema
    PronyTerm& term = material.viscosity[i++];
    term.time = given["time"];
    read(given, "shear", term.shear);
    read(given, "bulk", term.bulk);
  }
}

// A material with the keys that its tissue stands for and that it does not have itself.
json with_tissue(json entry) {
  if (!entry.contains("tissue")) return entry;
  const Tissue& tissue = *find_tissue(entry["tissue"].get<std::string>());  // the schema knows no others
  entry.emplace("name", tissue.name);
  entry.emplace("density", tissue.density);
  if (entry.contains("lame_mu") || entry.contains("young_modulus_along")) return entry;
  entry.emplace("young_modulus", tissue.young_modulus);
  entry.emplace("poisson_ratio", tissue_poisson_ratio);
  return entry;
}

Material read_material(const json& given, const std::string& pointer) {
  const json entry = with_tissue(given);
  Material material;
  read(entry, "name", material.name);
  read(entry, "density", material.density);
  read(entry, "fracture_energy", material.fracture_energy);
  if (entry.contains("nodal_pressure")) {
    const json& share = entry["nodal_pressure"];
    material.nodal_pressure = share.is_boolean() ? double(share.get<bool>()) : share.get<double>();
  }
  if (entry.contains("element"))
    material.element =
        entry["element"] == "edge-smoothed" ? ElementType::edge_smoothed : ElementType::tetrahedron;
  read_law(entry, pointer, material);
  read_viscosity(entry, material);
  read_families(entry, pointer, material);
  if (entry.contains("young_modulus_along")) {
    read_transverse(entry, material);
  } else if (entry.contains("young_modulus")) {
    const LamePair lame = lame_from_young(entry["young_modulus"], entry["poisson_ratio"]);
    material.lame_lambda = lame.lambda;
    material.lame_mu = lame.mu;
  } else {
    material.lame_lambda = entry["lame_lambda"];
    material.lame_mu = entry["lame_mu"];
  }
  material.where = read_where(entry);
  material.pointer = pointer;
  if (const std::string fault = law_fault(elastic_of(material)); !fault.empty())
    throw InputError({{pointer + "/law", fault}});
  if (const std::string fault = viscosity_fault(elastic_of(material)); !fault.empty())
    throw InputError({{pointer + "/viscosity", fault}});
  return material;
}

HoldBy read_hold_by(const json& entry) {
  const auto at = std::find(hold_by_names.begin(), hold_by_names.end(), entry.value("hold_by", "vertices"));
  return static_cast<HoldBy>(at - hold_by_names.begin());  // the schema knows no others
}

Boundary read_boundary(const json& entry, const std::string& pointer) {
  Boundary boundary;
  boundary.where = keys::read_from<Selector>(entry["where"]);
  boundary.hold_by = read_hold_by(entry);
  boundary.pointer = pointer;
  const auto take = [&](const char* key, Boundary::Kind kind) {
    if (!entry.contains(key)) return;
    boundary.kind = kind;
    boundary.value = read_vector(entry[key]);
  };
  if (entry.contains("displacement")) {
    boundary.kind = Boundary::Kind::displacement;
    for (int i = 0; i < 3; ++i) {
      const json& component = entry["displacement"][std::size_t(i)];
      boundary.axes[i] = !component.is_null();
      boundary.value[i] = component.is_null() ? 0 : component.get<double>();
    }
  }
  take("traction", Boundary::Kind::traction);
  take("force", Boundary::Kind::force);
  if (entry.contains("pressure")) {
    boundary.kind = Boundary::Kind::pressure;
    boundary.pressure = entry["pressure"];
  }
  return boundary;
}

Tool read_tool(const json& entry, const std::string& pointer) {
  Tool tool;
  tool.type = tool.name = entry["type"];
  read(entry, "name", tool.name);
  tool.where = read_where(entry);
  tool.hold_by = read_hold_by(entry);
  const ToolKind& kind = kind_of(tool);
  kind.read(entry, tool);
  for (const json& row : entry["path"]) {
    PathPoint& point = tool.path.emplace_back();
    point.time = row[0].get<double>();
    point.position = read_vector(row, 1);
    if (!kind.read_row(row, tool))
      throw InputError(pointer + "/path/" + std::to_string(tool.path.size() - 1),
                       "a row has " + std::string(kind.row) + ", not " + std::to_string(row.size()));
  }
  tool.pointer = pointer;
  return tool;
}

template <class Entry>
void read_entries(const json& document, const char* key, std::vector<Entry>& entries,
                  Entry (*read_entry)(const json&, const std::string&)) {
  if (!document.contains(key)) return;
  const std::string pointer = child_pointer("", key);
  for (const json& entry : document[key]) {
    entries.push_back(read_entry(entry, child_pointer(pointer, entries.size())));
  }
}

template <class Entry>
void read_list(const json& document, const char* key, std::vector<Entry>& entries) {
  if (document.contains(key)) keys::read_value(document[key], entries, child_pointer("", key));
}

void read_contact(const json& object, Scene& scene) {
  read(object, "self", scene.contact.self);
  read(object, "friction", scene.contact.friction);
  read(object, "damping", scene.contact.damping);
  for (const json& entry : object.value("obstacles", json::array())) {
    ObstacleSetup& obstacle = scene.contact.obstacles.emplace_back();
    obstacle.name = "obstacle";
    read(entry, "name", obstacle.name);
    obstacle.shape = read_shape(entry["shape"], scene.obstacle_files.emplace_back());
    if (entry.contains("position")) obstacle.position = read_vector(entry["position"]);
    read_orientation(entry, obstacle.orientation);
    read(entry, "friction", obstacle.friction);
  }
}

// Of a document that satisfies the schema.
Scene from_document(const json& document) {
  Scene scene;
  read(document, "name", scene.name);
  read_path(document, "mesh", scene.mesh);
  read(document, "mesh_scale", scene.mesh_scale);
  read_list(document, "bodies", scene.bodies);
  read(document, "volume_penalty", scene.volume_penalty);
  read(document, "guard_below", scene.guard_below);
  read_entries(document, "materials", scene.materials, read_material);
  if (document.contains("regions") && document["regions"].is_object())
    keys::read_value(document["regions"]["auto"], scene.auto_regions, "/regions/auto");
  else
    read_list(document, "regions", scene.regions);
  read_entries(document, "boundary", scene.boundary, read_boundary);
  read_entries(document, "tools", scene.tools, read_tool);
  read_list(document, "threads", scene.threads);
  read_list(document, "attachments", scene.attachments);
  if (document.contains("contact")) read_contact(document["contact"], scene);
  if (document.contains("gravity")) scene.gravity = read_vector(document["gravity"]);
  const std::string pieces = document.value("loose_pieces", "fall");
  if (pieces == "vanish") scene.loose_pieces = LoosePieces::vanish;
  if (pieces == "stay") scene.loose_pieces = LoosePieces::stay;
  read_path(document, "skin", scene.skin);
  if (document.contains("time")) keys::read_keys(document["time"], scene.time, "/time");
  if (document.contains("output")) keys::read_keys(document["output"], scene.output, "/output");
  return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "cannot be read: " + error.message());
  if (size > max_json_bytes) {
    throw InputError(file.string(), "longer than " + std::to_string(max_json_bytes >> 20) + " MB");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text(size, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (!stream) throw InputError(file.string(), "cannot be read");
  return parse_scene(text, file);
}

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  return read_document(parse_json(text, file.string()), file);
}

Scene read_document(const json& document, const std::filesystem::path& file) {
  std::vector<Fault> faults = schema_faults(document, file.string());
  if (!faults.empty()) throw InputError(std::move(faults));
  Scene scene = from_document(document);
  scene.file = file;
  faults = semantic_faults(scene);
  if (!faults.empty()) throw InputError(std::move(faults));
  return scene;
}

std::filesystem::path mesh_path(const Scene& scene) {
  if (!scene.bodies.empty())
    throw InputError(scene.file.string(), "has several bodies; here a scene of one mesh is needed");
  return scene.file.parent_path() / scene.mesh;
}
std::filesystem::path skin_path(const Scene& scene) { return scene.file.parent_path() / scene.skin; }

Scene with_absolute_paths(Scene scene) {
  const std::filesystem::path folder = std::filesystem::absolute(scene.file).parent_path();
  const auto complete = [&](std::filesystem::path& path) {
    if (!path.empty()) path = folder / path;
  };
  complete(scene.mesh);
  for (SceneBody& body : scene.bodies) complete(body.mesh);
  complete(scene.skin);
  for (Tool& tool : scene.tools) complete(tool.shape_file);
  for (std::filesystem::path& file : scene.obstacle_files) complete(file);
  return scene;
}

}  // namespace lobe
