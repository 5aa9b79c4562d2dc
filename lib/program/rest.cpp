// `lobe rest`: the mesh of the unloaded shape of a body.
#include "lobe/solve/rest_shape.h"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"

namespace lobe::program {
namespace {

// What a scene selects by place may be other vertices of the unloaded shape.
std::vector<std::string> differences(const Setup& loaded, const Scene& scene, const TetMesh& rest) {
  const std::string remedy = "; select by labels, surfaces or numbers of vertices in its place";
  Setup there;
  try {
    there = resolve(scene, rest, {false}).setup;
  } catch (const InputError& error) {
    return {std::string("the scene does not fit the unloaded shape: ") + error.what() + remedy};
  }
  const auto held = [](const Setup& setup) {
    std::vector<Index> vertices;
    for (const PrescribedVertex& p : setup.prescribed) vertices.push_back(p.vertex);
    return vertices;
  };
  std::vector<std::string> found;
  if (held(there) != held(loaded))
    found.push_back("the scene's \"boundary\" holds other vertices of the unloaded shape" + remedy);
  if (there.material_of != loaded.material_of)
    found.push_back("the scene's \"materials\" take other tetrahedra of the unloaded shape" + remedy);
  if (there.region_of != loaded.region_of)
    found.push_back("the scene's \"regions\" take other tetrahedra of the unloaded shape" + remedy);
  return found;
}

}  // namespace

int rest(const RestOptions& options) {
  if (options.output.extension() != ".vtu")
    throw InputError(options.output.string(), "the mesh is written as VTU; give a name that ends in .vtu");
  Scene scene = read_scene(options.scene);
  if (!options.mesh.empty()) replace_mesh(options.mesh, scene);
  MeshFile file = read_scene_mesh(scene);
  bind_groups(file, scene);
  print_warnings(file.warnings());
  const Resolved resolved = resolve(scene, std::move(file.mesh), {false});
  print_warnings(resolved.warnings);
  const Setup& loaded = resolved.setup;
  const auto tell = [&](int iteration, double distance) {
    if (options.json) return;
    std::printf("%3d  loaded, it is %.3g mm off\n", iteration, 1000 * distance);
    std::fflush(stdout);
  };
  RestShapeOptions search{.tolerance = options.tolerance, .progress = tell};
  search.statics.factor = linked_solver.make;
  const RestShape found = find_rest_shape(loaded, search);
  TetMesh mesh = loaded.mesh;
  mesh.points = found.points;
  write_vtu(options.output, mesh, {{"displacement", found.u}});
  print_warnings(differences(loaded, scene, mesh));
  if (!found.converged) print_errors(found.reason);
  const Eigen::RowVectorXd moved = (found.points - loaded.mesh.points).colwise().norm();
  if (options.json)
    std::cout << nlohmann::ordered_json{{"ok", found.converged},
                                        {"iterations", found.iterations},
                                        {"largest_distance_loaded_m", found.distance},
                                        {"largest_distance_unloaded_m", moved.maxCoeff()},
                                        {"mean_distance_unloaded_m", moved.mean()},
                                        {"reason", found.reason}}
                     .dump(1)
              << '\n';
  else
    std::printf(
        "unloaded, its vertices are up to %.3g mm from the scene's mesh, %.3g mm on average\n"
        "loaded, they are within %.2g mm of it\nwritten to %s\n",
        1000 * moved.maxCoeff(), 1000 * moved.mean(), 1000 * found.distance, options.output.string().c_str());
  return found.converged ? done : ended_early;
}

}  // namespace lobe::program
