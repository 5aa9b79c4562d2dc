// `lobe fit`: the parameters of materials from measurements.
#include "lobe/fit/fit.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/default_element.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "lobe/text.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;

Resolved load(const Scene& scene, Scene& bound) {
  bound = scene;
  MeshFile file = read_scene_mesh(bound);
  bind_groups(file, bound);
  print_warnings(file.warnings());
  Resolved resolved = resolve(bound, std::move(file.mesh), {false});
  print_warnings(resolved.warnings);
  return resolved;
}

void refuse_late_times(const Observations& observed, const Time& time, const std::string& file) {
  const std::vector<double> times = observed.times();
  if (!times.empty() && times.back() > time.duration * (1 + 1e-9))
    throw InputError(file, "has a number at " + rounded(times.back()) + " s, but the scene ends after " +
                               rounded(time.duration) + " s");
}

void warn_of_what_equilibria_leave_out(const Scene& scene) {
  std::vector<std::string> left_out;
  if (!scene.tools.empty()) left_out.push_back("tools are");
  for (const std::string& key : scene.force_keys()) left_out.push_back(key + " are");
  if (scene.contact.is_on()) left_out.push_back("contact is");
  for (const std::string& what : left_out)
    print_warnings({what + " left out of an equilibrium; a table with times is of the motion"});
}

std::vector<FitCase> load_cases(const FitCommand& command, std::vector<Scene>& scenes) {
  if (command.data.size() != command.scenes.size())
    throw InputError("--to", "needs one table for each scene: there are " +
                                 std::to_string(command.scenes.size()) + " scene(s) and " +
                                 std::to_string(command.data.size()) + " table(s)");
  std::vector<FitCase> cases;
  for (std::size_t i = 0; i < command.scenes.size(); ++i) {
    scenes.push_back(read_scene(command.scenes[i]));
    std::vector<Measurement> measured = read_measurements(command.data[i]);
    Scene bound;
    Resolved resolved = load(scenes.back(), bound);
    Observations observed(resolved, std::move(measured), command.data[i].string());
    if (observed.times().empty()) warn_of_what_equilibria_leave_out(scenes.back());
    refuse_late_times(observed, scenes.back().time, command.data[i].string());
    cases.push_back({std::move(resolved.setup), std::move(observed),
                     find_parameters(scenes.back(), command.parameters),
                     frames_of(scenes.back().time).length});
  }
  return cases;
}

bool is_told(const FittedParameter& p) { return p.is_identifiable && std::isfinite(p.high - p.low); }

Json json_of(const FitResult& found, const std::vector<FitCase>& cases) {
  Json parameters = Json::array(), measurements = Json::array();
  for (const FittedParameter& p : found.parameters)
    parameters.push_back({{"name", p.name},
                          {"start", p.start},
                          {"value", p.value},
                          {"low", is_told(p) ? Json(p.low) : Json()},
                          {"high", is_told(p) ? Json(p.high) : Json()},
                          {"identifiable", p.is_identifiable}});
  for (std::size_t c = 0; c < cases.size(); ++c)
    for (std::size_t i = 0; i < cases[c].observed.measurements().size(); ++i) {
      const Measurement& m = cases[c].observed.measurements()[i];
      measurements.push_back({{"case", c},
                              {"line", m.line},
                              {"measured", m.value},
                              {"computed", found.values[c][Eigen::Index(i)]}});
    }
  return {{"ok", found.converged},
          {"reason", found.reason},
          {"parameters", parameters},
          {"misfit", found.misfit},
          {"misfit_at_start", found.misfit_at_start},
          {"iterations", found.iterations},
          {"notes", found.notes},
          {"measurements", measurements}};
}

void print(const FitResult& found) {
  std::printf("%-32s %12s %12s   %s\n", "parameter", "start", "fitted", "95 % interval");
  for (const FittedParameter& p : found.parameters) {
    const std::string interval = is_told(p) ? rounded(p.low) + " to " + rounded(p.high) : "not told";
    std::printf("%-32s %12s %12s   %s\n", p.name.c_str(), rounded(p.start).c_str(), rounded(p.value).c_str(),
                interval.c_str());
  }
  std::printf("misfit %s, at the start %s, after %d iterations\n", rounded(found.misfit).c_str(),
              rounded(found.misfit_at_start).c_str(), found.iterations);
  for (const std::string& note : found.notes) std::printf("note: %s\n", note.c_str());
}

void write_fitted(const FitCommand& command, Scene scene, const FitResult& found) {
  const std::vector<Parameter> parameters = find_parameters(scene, command.parameters);
  // What was fitted is named: the default would follow the ratio of Poisson that was found.
  std::vector<Material> named;
  for (const Material& material : scene.materials) named.push_back(with_default_element(scene, material));
  scene.materials = std::move(named);
  for (std::size_t j = 0; j < parameters.size(); ++j) set(parameters[j], found.parameters[j].value, scene);
  io::write_file(command.output, to_json(with_absolute_paths(std::move(scene))) + '\n');
}

}  // namespace

int fit(const FitCommand& command) {
  std::vector<Scene> scenes;
  const std::vector<FitCase> cases = load_cases(command, scenes);
  FitOptions options;
  options.statics.factor = linked_solver.make;
  options.progress = [&](int iteration, double misfit) {
    if (!command.json) std::printf("%3d  misfit %s\n", iteration, rounded(misfit).c_str());
    std::fflush(stdout);
  };
  const FitResult found = lobe::fit(cases, options);
  if (command.json)
    std::cout << json_of(found, cases).dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print(found);
  if (!found.converged) print_errors(found.reason);
  if (!command.output.empty() && found.converged) write_fitted(command, scenes[0], found);
  return found.converged ? done : ended_early;
}

}  // namespace lobe::program
