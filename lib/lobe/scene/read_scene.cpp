#include "lobe/scene/read_scene.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "lobe/error.h"
#include "lobe/fem/law_fault.h"
#include "lobe/file/scanner.h"
#include "lobe/scene/check_scene.h"
#include "lobe/scene/explain.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/material_keys.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/scene_document.h"
#include "lobe/scene/scene_keys.h"
#include "lobe/scene/tissues.h"

namespace lobe {
namespace {

using nlohmann::json;

// Constants and fibres that the law of a material does not have, or needs.
void check_law(const json& entry, const std::string& pointer, const Material& material) {
  const LawRow& law = law_rows[std::size_t(material.law)];
  for (const LawRow& row : law_rows)
    for (const char* key : row.keys)
      if (key && row.name != law.name && entry.contains(key))
        throw InputError(pointer + "/" + key, "is a modulus of \"law\": \"" + std::string(row.name) +
                                                  "\", but the law is \"" + law.name + "\"");
  if (has_families(material.law)) {
    if (!material.fibre) throw InputError(pointer + "/fibre", "is missing: which way the fibres run");
    return;
  }
  for (const char* key : {"holzapfel_angle", "holzapfel_plane"})
    if (entry.contains(key)) throw InputError(pointer + "/" + key, "is of \"law\": \"holzapfel\" alone");
  if (material.fibre && !material.transverse)
    throw InputError(pointer + "/fibre",
                     "needs constants along and across fibres (young_modulus_along and four more), or "
                     "\"law\": \"holzapfel\"");
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

// Keys that no table has: automatic regions, and files of shapes.
void read_rest(const json& document, Scene& scene) {
  if (document.contains("regions") && document["regions"].is_object()) {
    scene.regions.clear();
    keys::read_value(document["regions"]["auto"], scene.auto_regions, "/regions/auto");
  }
  if (!document.contains("contact")) return;
  for (const json& obstacle : document["contact"].value("obstacles", json::array()))
    scene.obstacle_files.push_back(shape_file(obstacle["shape"]));
}

// What programs take for a body rather than for a scene.
bool is_body_file(const std::filesystem::path& file) {
  static constexpr std::string_view extensions[] = {".vtu", ".vtk",  ".msh", ".msh2", ".mesh", ".node",
                                                    ".ele", ".stl",  ".obj", ".ply",  ".off",  ".vtp",
                                                    ".nii", ".nrrd", ".gz",  ".nhdr"};
  const std::string extension = io::lower_case(file.extension().string());
  return std::ranges::find(extensions, extension) != std::end(extensions);
}

}  // namespace

void keys::Form<Material>::read(const json& given, Material& material, const std::string& place) {
  const json entry = with_tissue(given);
  material.pointer = place;
  read_rows(material_keys, entry, material, place);
  check_law(entry, place, material);
  if (entry.contains("young_modulus")) {
    const LamePair lame = lame_from_young(entry["young_modulus"], entry["poisson_ratio"]);
    material.lame_lambda = lame.lambda;
    material.lame_mu = lame.mu;
  }
  if (const std::string fault = law_fault(elastic_of(material)); !fault.empty())
    throw InputError(place + "/law", fault);
  if (const std::string fault = viscosity_fault(elastic_of(material)); !fault.empty())
    throw InputError(place + "/viscosity", fault);
}

Scene read_scene(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "cannot be read: " + error.message());
  if (is_body_file(file))
    throw InputError(file.string(), "is no scene but a mesh, a surface or an image: lobe scene " +
                                        file.filename().string() +
                                        " writes a scene for it, lobe view shows it");
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
  Scene scene;
  keys::read_rows(keys::scene_keys, document, scene, "");
  read_rest(document, scene);
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
  for (Tool& tool : scene.tools)
    if (std::filesystem::path* file = tool.shape_file()) complete(*file);
  for (std::filesystem::path& file : scene.obstacle_files) complete(file);
  return scene;
}

}  // namespace lobe
