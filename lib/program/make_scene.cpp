// A scene for a mesh or a surface that has none: units, material and what is held are proposed and said.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "held_parts.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/nearest_word.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/tissues.h"
#include "lobe/scene/unit_checks.h"
#include "lobe/text.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr double largest_organ = 2;  // [m] across; what is larger is taken to be in millimetres

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// Both tetrahedra and surfaces are in .vtk and .vtu.
bool may_hold_a_surface(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  for (const char* of_mesh : {".msh", ".msh2", ".mesh", ".node", ".ele"})
    if (extension == of_mesh) return false;
  return true;
}

bool may_hold_tetrahedra(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return !may_hold_a_surface(file) || extension == ".vtk" || extension == ".vtu";
}

struct ScaledMesh {
  MeshFile file;                    // in metres
  std::filesystem::path mesh;       // its file
  double scale = 1;                 // from the file's coordinates to metres
  std::vector<std::string> said{};  // warnings of lobe-mesh, which has printed them
};

double found_scale(const TetMesh& mesh) { return box_diagonal(mesh) > largest_organ ? 0.001 : 1; }

ScaledMesh read_body(const MakeSceneOptions& options, std::filesystem::path mesh) {
  ScaledMesh body{read_mesh(mesh), std::move(mesh)};
  body.scale = options.scale > 0 ? options.scale : found_scale(body.file.mesh);
  body.file.mesh.points *= body.scale;
  return body;
}

std::filesystem::path made_mesh(const MakeSceneOptions& options) {
  std::filesystem::path mesh = options.output;
  mesh.replace_extension(".vtu");
  for (const std::filesystem::path& file : options.files)
    if (std::filesystem::exists(mesh) && std::filesystem::equivalent(mesh, file))
      throw InputError("--output", options.output.string() + ": the mesh beside it would be " +
                                       mesh.string() + ", which is the input; give another name");
  return mesh;
}

std::vector<std::string> arguments_of_mesher(const MakeSceneOptions& options,
                                             const std::filesystem::path& mesh,
                                             const std::filesystem::path& report) {
  std::vector<std::string> arguments{sibling("lobe-mesh").string()};
  for (const std::filesystem::path& file : options.files) arguments.push_back(file.string());
  arguments.insert(arguments.end(), {"-o", mesh.string(), "--report", report.string()});
  if (options.scale > 0)
    arguments.insert(arguments.end(), {"--scale", exact(options.scale)});
  else
    arguments.push_back("--find-units");
  if (options.voxels > 0)
    arguments.insert(arguments.end(), {"--voxels", exact(options.voxels)});
  else if (options.files.size() > 1)
    arguments.push_back("--find-voxels");
  if (options.edge > 0) arguments.insert(arguments.end(), {"--edge", exact(options.edge)});
  if (options.accepts_loss) arguments.push_back("--accept-loss");
  return arguments;
}

// Removes the report, which nobody else needs.
std::vector<std::string> warnings_of(const std::filesystem::path& report) {
  std::vector<std::string> warnings;
  std::ifstream in(report);
  const Json json = Json::parse(in, nullptr, false);
  if (json.is_object() && json.contains("warnings"))
    for (const Json& warning : json["warnings"])
      if (warning.is_string()) warnings.push_back(warning.get<std::string>());
  in.close();
  std::error_code ignored;
  std::filesystem::remove(report, ignored);
  return warnings;
}

// Runs lobe-mesh, which says what it repairs and how good the mesh is.
ScaledMesh meshed_body(const MakeSceneOptions& options) {
  const std::filesystem::path mesh = made_mesh(options);
  std::filesystem::path report = mesh;
  report += ".report.json";
  const int status = run_program(arguments_of_mesher(options, mesh, report));
  std::vector<std::string> said = warnings_of(report);
  if (status == 127)
    throw InputError("lobe-mesh", "not found in the folder of lobe or on the PATH; ./dev build makes it");
  if (status != 0) throw InputError(options.files.front().string(), "was not meshed");
  ScaledMesh body{read_mesh(mesh), mesh, 1, std::move(said)};
  for (std::size_t k = 0; options.files.size() > 1 && k < options.files.size(); ++k)
    body.file.label_names[static_cast<int>(k)] = options.files[k].stem().string();
  return body;
}

ScaledMesh find_body(const MakeSceneOptions& options) {
  const std::filesystem::path& file = options.files.front();
  if (options.files.size() > 1 || !may_hold_tetrahedra(file)) return meshed_body(options);
  try {
    return read_body(options, file);
  } catch (const InputError& error) {
    const bool may_be =
        std::string(error.what()).find("a surface is meshed by lobe-mesh") != std::string::npos;
    if (!may_be || !may_hold_a_surface(file)) throw;
  }
  return meshed_body(options);
}

Json materials_of(const MeshFile& file, const std::string& tissue) {
  std::vector<int> labels = file.mesh.labels;
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  if (labels.size() < 2) return {{{"tissue", tissue}}};
  Json materials = Json::array();
  for (const int label : labels) {
    const auto name = file.label_names.find(label);
    const std::string called =
        name == file.label_names.end() ? "label " + std::to_string(label) : name->second;
    materials.push_back({{"name", called}, {"tissue", tissue}, {"where", {{"label", label}}}});
  }
  return materials;
}

// A number as people write it: four digits.
double short_number(double value) { return std::stod(rounded(value)); }

Json scene_json(const MakeSceneOptions& options, const ScaledMesh& body, const HeldParts& held) {
  const Tissue& tissue = *find_tissue(options.tissue);
  // Twice the bulk modulus, E/(3 (1 − 2ν)), as in the scenes of data/.
  const double penalty = 2 * tissue.young_modulus / (3 * (1 - 2 * tissue_poisson_ratio));
  const auto folder = std::filesystem::absolute(options.output).parent_path();
  Json json{{"name", options.output.stem().string()},
            {"mesh", std::filesystem::proximate(std::filesystem::absolute(body.mesh), folder).string()}};
  if (body.scale != 1) json["mesh_scale"] = body.scale;
  json["materials"] = materials_of(body.file, options.tissue);
  json["volume_penalty"] = short_number(penalty);
  json["guard_below"] = 0.2;
  write_held_parts(held, json);
  json["time"] = {{"duration", 10}, {"frame", 0.02}, {"damping", 15}};
  json["output"] = {{"every", 0.1}};
  return json;
}

void check_options(const MakeSceneOptions& options) {
  std::vector<Fault> faults;
  if (!find_tissue(options.tissue)) {
    std::vector<std::string> known;
    for (const Tissue& tissue : tissues()) known.emplace_back(tissue.name);
    const std::string near = nearest_word(options.tissue, known);
    faults.push_back({"--tissue", "\"" + options.tissue + "\" is none that lobe tissues lists" +
                                      (near.empty() ? "" : "; did you mean \"" + near + "\"?")});
  }
  if (lower_extension(options.output) != ".json")
    faults.push_back({"--output", options.output.string() + ": expected a name that ends in .json"});
  if (options.hold == "none" && options.pins.empty())
    faults.push_back({"--hold", "none: then nothing holds the body, unless there are pins (--pin X,Y,Z)"});
  if (options.hold == "none" && options.springs > 0)
    faults.push_back({"--springs", "are those of a side, but --hold is none"});
  for (const std::filesystem::path& file : options.files)
    if (!std::filesystem::exists(file)) faults.push_back({file.string(), "no such file"});
  if (!faults.empty()) throw InputError(std::move(faults));
}

void print_choices(const MakeSceneOptions& options, const ScaledMesh& body, const HeldParts& held) {
  const TetMesh& mesh = body.file.mesh;
  const Vec3d size = bounding_box(mesh).max - bounding_box(mesh).min;
  const Tissue& tissue = *find_tissue(options.tissue);
  std::printf("mesh       %s: %d tetrahedra, %s × %s × %s m\n", body.mesh.string().c_str(), mesh.tet_count(),
              rounded(size.x()).c_str(), rounded(size.y()).c_str(), rounded(size.z()).c_str());
  if (body.scale != 1 && options.scale == 0)
    std::printf("units      millimetres, by its size (--scale 1 if they are metres)\n");
  std::printf("material   %s: E %s kPa, nu %s, density %s kg/m³ (--tissue; lobe tissues lists them)\n",
              options.tissue.c_str(), rounded(tissue.young_modulus / 1000).c_str(),
              rounded(tissue_poisson_ratio).c_str(), rounded(tissue.density).c_str());
  for (const std::string& line : words_of(held, options)) std::printf("held       %s\n", line.c_str());
  std::printf("gravity    none: a shape that was measured in place has its weight in it\n");
  std::printf("written to %s\n", options.output.string().c_str());
}

}  // namespace

std::filesystem::path default_scene(const MakeSceneOptions& options) {
  return options.files.front().stem().string() + "_scene.json";
}

int make_scene(const MakeSceneOptions& given, std::vector<std::string>* warnings_of_mesher) {
  MakeSceneOptions options = given;
  if (options.output.empty()) options.output = default_scene(options);
  check_options(options);
  ScaledMesh body = find_body(options);
  const HeldParts held = find_held_parts(options, body.file.mesh);
  const std::string text = scene_json(options, body, held).dump(2) + "\n";
  Scene scene = parse_scene(text, options.output);
  bind_groups(body.file, scene);
  scene.mesh_scale = 1;  // it is in metres here
  std::vector<std::string> warnings = body.file.warnings();
  for (std::string& warning : resolve(scene, body.file.mesh, {false, {}}).warnings)
    warnings.push_back(std::move(warning));
  print_warnings(warnings);
  io::write_file(options.output, text);
  print_choices(options, body, held);
  if (warnings_of_mesher)
    warnings_of_mesher->insert(warnings_of_mesher->end(), body.said.begin(), body.said.end());
  return done;
}

}  // namespace lobe::program
