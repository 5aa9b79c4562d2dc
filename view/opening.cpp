#include "opening.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "console.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/tissues.h"
#include "lobe/text.h"

namespace lobe::view {
namespace {

using Json = nlohmann::json;

// Its lines that tell of an error, without the name of the program; else the last line.
std::string errors_of(const std::string& said) {
  std::istringstream lines(said);
  std::string found, last;
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view mark = "error: ";
    if (const std::size_t at = line.find(mark); at != line.npos)
      found += (found.empty() ? "" : "\n") + line.substr(at + mark.size());
    if (!line.empty()) last = line;
  }
  return found.empty() ? last : found;
}

// The JSON object that a program has said, between warnings; discarded if there is none.
Json json_among(const std::string& said) {
  const std::size_t begin = said.starts_with('{') ? 0 : said.find("\n{"), end = said.rfind('}');
  if (begin == said.npos || end == said.npos || begin > end) return Json(Json::value_t::discarded);
  return Json::parse(said.substr(begin, end + 1 - begin), nullptr, false);
}

// Throws InputError with what is in trouble, and what the program says.
void run_lobe(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
              const std::string& trouble, Child& child) {
  const int status = child.run(arguments, folder);
  if (child.was_stopped()) throw InputError(trouble, "it was cancelled");
  if (status == 127)
    throw InputError(std::filesystem::path(arguments.front()).filename().string(),
                     "not found in the folder of lobe-view or on the PATH");
  if (status != 0) throw InputError(trouble, errors_of(child.said()));
}

// That all of the body has, by its moduli; empty if there is none.
std::string tissue_of(const Scene& scene) {
  for (const Tissue& tissue : tissues()) {
    const bool is_of_all =
        std::all_of(scene.materials.begin(), scene.materials.end(), [&](const Material& material) {
          const double young = young_modulus(material.lame_lambda, material.lame_mu);
          return !material.transverse && std::abs(young - tissue.young_modulus) < 1e-9 * young &&
                 material.density == tissue.density;
        });
    if (is_of_all) return std::string(tissue.name);
  }
  return {};
}

// The side that a selector takes, as `lobe scene` names it; empty if it is none.
std::string side_of(const Selector& where) {
  const auto* plane = std::get_if<SelectPlane>(&where.value);
  if (!plane || plane->side != SelectPlane::Side::above) return {};
  for (int k = 0; k < 3; ++k)
    if (std::abs(plane->normal[k]) == plane->normal.norm())
      return std::string(1, "xyz"[k]) + (plane->normal[k] > 0 ? "+" : "-");
  return {};
}

// What holds a scene, as `lobe scene` makes it: "hold" is empty for what it does not make.
Json holding_of(const Scene& scene) {
  std::string side;
  double springs = 0;
  Json pins = Json::array();
  bool is_known = scene.boundary.size() + scene.attachments.size() > 0;
  const auto hold_side = [&](const Selector& where) {
    const std::string found = side_of(where);
    is_known = is_known && side.empty() && !found.empty();
    side = found;
  };
  for (const Boundary& entry : scene.boundary) {
    const auto* ball = std::get_if<SelectSphere>(&entry.where.value);
    if (entry.kind != Boundary::Kind::fix)
      is_known = false;
    else if (ball)
      pins.push_back({ball->center[0], ball->center[1], ball->center[2]});
    else
      hold_side(entry.where);
  }
  for (const SceneAttachment& attachment : scene.attachments) {
    const auto* bed = std::get_if<SceneBed>(&attachment.what);
    if (!bed || bed->to || bed->fracture_energy) {
      is_known = false;
      continue;
    }
    hold_side(bed->from);
    springs = bed->stiffness;
  }
  if (!is_known) return {{"hold", ""}, {"springs", 0.0}, {"pins", Json::array()}};
  return {{"hold", side.empty() ? "none" : side}, {"springs", springs}, {"pins", pins}};
}

// Files of VTK may have tetrahedra, triangles or both; `lobe scene` then takes the tetrahedra.
bool has_tetrahedra(const std::filesystem::path& file) {
  if (file.extension() != ".vtu" && file.extension() != ".vtk") return false;
  try {
    return read_mesh(file).mesh.tet_count() > 0;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

Choices carried_over(Origin& origin, const Choices& wanted) {
  if (wanted.scale != 0) origin.edge = 0;
  if (wanted.scale != 0) origin.scale = std::max(0.0, wanted.scale);
  if (wanted.edge > 0) origin.edge = wanted.edge;
  return {wanted.tissue, wanted.hold, origin.edge, origin.scale, wanted.springs, wanted.pins};
}

std::filesystem::path make_scene_file(const Origin& origin, const Choices& choices,
                                      const std::filesystem::path& folder, Child& child) {
  const std::filesystem::path scene = folder / (origin.files.front().stem().string() + ".json");
  std::vector<std::string> arguments{program::sibling("lobe").string(), "scene"};
  for (const std::filesystem::path& file : origin.files) arguments.push_back(file.string());
  arguments.insert(arguments.end(), {"-o", scene.string()});
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty() && value != "0") arguments.insert(arguments.end(), {option, value});
  };
  add("--tissue", choices.tissue);
  add("--hold", choices.hold);
  add("--edge", exact(choices.edge));
  add("--scale", exact(choices.scale));
  add("--springs", exact(choices.springs));
  for (const Vec3d& pin : choices.pins)
    add("--pin", exact(pin.x()) + "," + exact(pin.y()) + "," + exact(pin.z()));
  run_lobe(arguments, folder, origin.files.front().filename().string() + " was not opened", child);
  return scene;
}

std::vector<std::string> warnings_of_mesher(const std::string& said) {
  std::istringstream lines(said);
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view mark = "lobe-mesh: warning: ";
    if (const std::size_t at = line.find(mark); at != line.npos)
      found.push_back(line.substr(at + mark.size()));
  }
  return found;
}

Json size_of_files(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder,
                   Child& child) {
  const std::string trouble = "its size was not found";
  if (files.size() == 1 && has_tetrahedra(files.front()))
    throw InputError(trouble, "it has tetrahedra, which stay as they are");
  std::vector<std::string> arguments{program::sibling("lobe-mesh").string(), "--measure"};
  for (const std::filesystem::path& file : files) arguments.push_back(file.string());
  run_lobe(arguments, folder, trouble, child);
  Json size = json_among(child.said());
  if (!size.is_object()) throw InputError(trouble, "lobe-mesh has not said it");
  return size;
}

Json total_errors_of(const std::filesystem::path& scene, const std::filesystem::path& folder, Child& child) {
  const std::string trouble = "the error was not measured";
  run_lobe({program::sibling("lobe").string(), "check", scene.string(), "--total-error", "--json"}, folder,
           trouble, child);
  const Json description = json_among(child.said());
  if (description.is_object() && description.contains("total_error")) return description["total_error"];
  throw InputError(trouble, "lobe check has not said it");
}

std::pair<Scene, Resolved> load_scene(const std::filesystem::path& file,
                                      const std::function<void(double fraction)>& progress) {
  Scene scene = read_scene(file);
  MeshFile mesh = read_scene_mesh(scene);
  bind_groups(mesh, scene);
  std::vector<std::string> warnings = mesh.warnings();
  Resolved resolved = resolve(scene, std::move(mesh.mesh), {true, progress});
  resolved.warnings.insert(resolved.warnings.begin(), warnings.begin(), warnings.end());
  return {std::move(scene), std::move(resolved)};
}

bool has_own_mesh(const Origin& origin) {
  std::error_code error;
  return origin.files.size() == 1 && std::filesystem::equivalent(origin.files.front(), origin.mesh, error);
}

Json note_choices(Origin& origin, const Scene& scene, const Resolved& resolved) {
  if (origin.files.empty() || !scene.bodies.empty()) return nullptr;
  origin.mesh = mesh_path(scene);
  origin.mesh_scale = scene.mesh_scale;
  const TetMesh& mesh = resolved.setup.mesh;
  const Vec3d size = bounding_box(mesh).max - bounding_box(mesh).min;
  const double volume = total_volume(mesh);
  Json files = Json::array();
  for (const std::filesystem::path& file : origin.files) files.push_back(file.filename().string());
  const Json holding = holding_of(scene);
  return {{"files", files},
          {"tissue", tissue_of(scene)},
          {"hold", holding["hold"]},
          {"springs", holding["springs"]},
          {"pins", holding["pins"]},
          {"edge", std::cbrt(6 * std::sqrt(2) * volume / mesh.tet_count())},
          {"has_own_mesh", has_own_mesh(origin)},
          {"scale", origin.scale},
          {"tets", mesh.tet_count()},
          {"volume", volume},
          {"size", {size[0], size[1], size[2]}},
          {"warnings", origin.warnings}};
}

}  // namespace lobe::view
