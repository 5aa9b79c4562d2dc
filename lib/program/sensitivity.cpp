// `lobe sensitivity`: what moves the sag and the forces of a scene most.
#include "lobe/fit/sensitivity.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "pictures.h"

namespace lobe::program {
namespace {

nlohmann::ordered_json effects_json(const std::vector<Sensitivity>& found) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Sensitivity& one : found) {
    nlohmann::ordered_json effects = nlohmann::ordered_json::array();
    for (const Effect& effect : one.effects)
      effects.push_back({{"of", effect.of},
                         {"displacement", effect.displacement},
                         {"largest", effect.largest},
                         {"force", effect.force},
                         {"trouble", effect.trouble}});
    list.push_back({{"gesture", one.gesture},
                    {"trouble", one.trouble},
                    {"largest_displacement_m", one.largest},
                    {"force_N", one.force},
                    {"effects", effects}});
  }
  return list;
}

// The name of a gesture's array: that of the weight without what it says about gravity.
std::string array_name(const Sensitivity& one) { return one.gesture.substr(0, one.gesture.find(',')); }

// Returns the name of the last array; empty if there is none.
std::string write_shares(const std::filesystem::path& file, const TetMesh& mesh,
                         const std::vector<Sensitivity>& found) {
  std::vector<DataArray> arrays;
  for (const Sensitivity& one : found) {
    if (one.of_tets.empty()) continue;
    DataArray array{array_name(one), Eigen::MatrixXd(1, mesh.tet_count())};
    for (Index t = 0; t < mesh.tet_count(); ++t) array.values(0, t) = one.of_tets[std::size_t(t)];
    arrays.push_back(std::move(array));
  }
  write_vtu(file, mesh, {}, arrays);
  return arrays.empty() ? "" : arrays.back().name;
}

void write_output(const SensitivityCommand& command, const TetMesh& mesh,
                  const std::vector<Sensitivity>& found) {
  const std::string last = write_shares(command.output, mesh, found);
  if (last.empty()) print_warnings({"there is no share of each tetrahedron where there is no equilibrium"});
  if (command.picture.empty() || last.empty()) return;
  const std::string trouble = draw_cells(command.output, last, command.picture);
  if (!trouble.empty()) print_warnings({trouble});
}

}  // namespace

int sensitivity(const SensitivityCommand& command) {
  if (!command.output.empty() && command.output.extension() != ".vtu")
    throw InputError(command.output.string(), "the mesh is written as VTU; give a name that ends in .vtu");
  if (command.output.empty() && !command.picture.empty())
    throw InputError("--picture", "draws the mesh that -o writes; give -o, too");
  Scene scene = read_scene(command.scene);
  MeshFile file = read_scene_mesh(scene);
  bind_groups(file, scene);
  print_warnings(file.warnings());
  const Resolved resolved = resolve(scene, std::move(file.mesh), {false});
  print_warnings(resolved.warnings);
  ProgressBar bar("solving");
  const std::vector<Sensitivity> found =
      sensitivities(scene, resolved, {linked_solver.make, [&](double fraction) { bar.show(fraction); }});
  if (command.json)
    std::cout << effects_json(found).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  else
    std::cout << sensitivity_table(found);
  if (!command.output.empty()) write_output(command, resolved.setup.mesh, found);
  const bool any_trouble =
      std::any_of(found.begin(), found.end(), [](const Sensitivity& one) { return !one.trouble.empty(); });
  return any_trouble ? ended_early : done;
}

}  // namespace lobe::program
