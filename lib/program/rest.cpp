// `lobe rest`: the unloaded shape of a body, and a scene that begins with it.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/run/solve.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/rest_scene.h"
#include "lobe/scene/scene_mesh.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;
using Files = std::vector<std::filesystem::path>;

// The image of a patient is not to be lost.
void refuse_overwriting(const Scene& scene, const RestOptions& options) {
  Files inputs = mesh_paths(scene);
  inputs.push_back(options.scene);
  if (!scene.skin.empty()) inputs.push_back(skin_path(scene));
  const std::filesystem::path stem = options.output.parent_path() / options.output.stem();
  Files outputs{options.output};
  for (const char* extension : {".vtu", ".msh"}) {
    if (options.output.extension() != ".json") break;
    outputs.push_back(stem.string() + extension);
    for (std::size_t i = 1; i <= scene.bodies.size(); ++i)
      outputs.push_back(stem.string() + '_' + std::to_string(i) + extension);
  }
  if (options.output.extension() == ".json") outputs.push_back(stem.string() + "_skin.obj");
  for (const auto& input : inputs)
    for (const auto& output : outputs)
      if (std::error_code none; std::filesystem::equivalent(input, output, none))
        throw InputError(output.string(), "is a file of the scene, which would be lost: give another name");
}

Files write(const std::filesystem::path& output, const RestScene& rest, const MeshFile& file) {
  if (output.extension() == ".json") return write_rest_scene(output, rest, file);
  write_rest_mesh(output, rest, file);
  if (!file.surfaces.empty() || !file.label_names.empty())
    print_warnings({output.string() +
                    ": the groups of surfaces and the names of labels are left out; a scene "
                    "(-o FILE.json) keeps them"});
  return {output};
}

std::string place(const Vec3d& point) {
  char text[128];
  std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g) m", point.x(), point.y(), point.z());
  return text;
}

struct Outcome {
  const RestShape& shape;
  const Mat3X<double>& given;  // [m]
  const Files& files;
  double seconds = 0;
  Eigen::RowVectorXd moved() const { return (shape.points - given).colwise().norm(); }  // [m]
};

void print_json(const Outcome& outcome, const std::vector<std::string>& notes) {
  const RestShape& shape = outcome.shape;
  Json files = Json::array();
  for (const auto& file : outcome.files) files.push_back(file.string());
  std::cout << Json{{"ok", shape.converged},
                    {"iterations", shape.iterations},
                    {"factorisations", shape.factorisations},
                    {"load_fraction", shape.load_fraction},
                    {"largest_distance_loaded_m", shape.distance},
                    {"mean_distance_loaded_m", shape.mean_distance},
                    {"farthest_vertex", shape.farthest},
                    {"largest_distance_unloaded_m", outcome.moved().maxCoeff()},
                    {"mean_distance_unloaded_m", outcome.moved().mean()},
                    {"reason", shape.reason},
                    {"notes", notes},
                    {"files", files},
                    {"wall_s", outcome.seconds}}
                   .dump(1, ' ', false, Json::error_handler_t::replace)
            << '\n';
}

void print(const Outcome& outcome, const std::vector<std::string>& notes) {
  const RestShape& shape = outcome.shape;
  std::printf("unloaded, its vertices are up to %.3g mm from the scene's mesh, %.3g mm on average\n",
              1000 * outcome.moved().maxCoeff(), 1000 * outcome.moved().mean());
  if (std::isfinite(shape.distance))
    std::printf(
        "loaded, they are within %.2g mm of it, %.2g mm on average; vertex %d at %s is the farthest\n",
        1000 * shape.distance, 1000 * shape.mean_distance, shape.farthest,
        place(outcome.given.col(shape.farthest)).c_str());
  std::printf("%d iterations, %d factorisations, %.2f s\n", shape.iterations, shape.factorisations,
              outcome.seconds);
  for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
  for (const auto& file : outcome.files) std::printf("written to %s\n", file.string().c_str());
}

}  // namespace

int rest(const RestOptions& options) {
  const std::filesystem::path extension = options.output.extension();
  if (extension != ".json" && extension != ".vtu")
    throw InputError(options.output.string(),
                     "give the scene to write (.json, with its mesh beside it) or the mesh alone (.vtu)");
  Scene scene = read_scene(options.scene);
  if (!options.mesh.empty()) replace_mesh(options.mesh, scene);
  refuse_overwriting(scene, options);
  const MeshFile file = read_scene_mesh(scene);
  bind_groups(file, scene);
  print_warnings(file.warnings());
  const Resolved resolved = resolve(scene, file.mesh, {false});
  print_warnings(resolved.warnings);
  print_warnings(left_out_of_statics(scene, resolved.setup));
  const auto tell = [&](int iteration, double distance) {
    if (options.json) return;
    std::printf("%3d  loaded, it is about %.3g mm off\n", iteration, 1000 * distance);
    std::fflush(stdout);
  };
  RestShapeOptions search{.tolerance = options.tolerance, .progress = tell};
  search.statics.factor = linked_solver.make;
  const auto start = std::chrono::steady_clock::now();
  const RestScene found = find_rest_scene(scene, file, resolved.setup, search);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Files files = write(options.output, found, file);
  print_warnings(found.warnings);
  if (!found.shape.converged) print_errors(found.shape.reason);
  const Outcome outcome{found.shape, resolved.setup.mesh.points, files, seconds};
  options.json ? print_json(outcome, found.notes) : print(outcome, found.notes);
  return found.shape.converged ? done : ended_early;
}

}  // namespace lobe::program
