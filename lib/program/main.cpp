// The command `lobe`: docs/commands.md lists its commands and their options.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/scene/nearest_word.h"
#include "lobe/text.h"

namespace {

using namespace lobe::program;
using Action = std::function<int()>;

// Starts another program. Parts under another licence, and parts that are not needed to run a scene, are
// separate programs.
int forward(const std::string& program, char** first, char** last, const std::string& option) {
  std::vector<std::string> arguments{sibling(program).string()};
  arguments.insert(arguments.end(), first, last);
  become_program(arguments);
  print_errors(program +
               ": not found in the folder of lobe or on the PATH; ./dev build makes it, where CMake has " +
               option + "=ON");
  return bad_input;
}

// Three numbers with commas between them.
lobe::Vec3d place_of(const std::string& option, const std::string& text) {
  lobe::Vec3d place;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int k = 0; k < 3; ++k) {
    if (k > 0 && (at == end || *at++ != ',')) throw CLI::ValidationError(option, text + ": expected X,Y,Z");
    const auto [after, fault] = std::from_chars(at, end, place[k]);
    if (fault != std::errc() || !std::isfinite(place[k]))
      throw CLI::ValidationError(option, text + ": expected X,Y,Z");
    at = after;
  }
  if (at != end) throw CLI::ValidationError(option, text + ": expected X,Y,Z");
  return place;
}

void add_make_scene_options(CLI::App& command, MakeSceneOptions& options) {
  command
      .add_option("--scale", options.scale,
                  "what coordinates are multiplied by, 0.001 for millimetres; default: by the size")
      ->check(CLI::Range(1e-9, 1e9));
  command.add_option("--edge", options.edge, "edge of the tetrahedra that a surface is filled with [m]")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--voxels", options.voxels,
                  "edge of voxels that surfaces are turned into first [m]: they may then overlap")
      ->check(CLI::PositiveNumber);
  command.add_flag("--accept-loss", options.accepts_loss,
                   "be content with a mesh that loses more than a quarter of a part's volume");
  command.add_option("--tissue", options.tissue, "of all of it; lobe tissues lists them")
      ->capture_default_str();
  command.add_option("--hold", options.hold, "side that is held, or none; default: the broadest one")
      ->check(CLI::IsMember(names_of_sides()));
  command
      .add_option("--springs", options.springs,
                  "of the bed on which that side lies, per area [Pa/m]; default: it is fixed")
      ->check(CLI::PositiveNumber);
  command.add_option_function<std::vector<std::string>>(
      "--pin",
      [&options](const std::vector<std::string>& pins) {
        for (const std::string& pin : pins) options.pins.push_back(place_of("--pin", pin));
      },
      "X,Y,Z: a place that is fixed, at the body at rest [m]; can be repeated");
}

// lobe view FILE… [options] of what is no scene: a scene is made for it, once, and then shown.
int make_and_view(int argc, char** argv) {
  CLI::App app("Makes a scene for FILE… and shows it; takes the options of lobe view SCENE, too",
               "lobe view FILE…");
  MakeSceneOptions options;
  std::vector<std::string> warnings;
  add_make_scene_options(app, options);
  app.allow_windows_style_options(false);
  app.allow_extras();
  int at = 2;
  for (; at < argc && argv[at][0] != '-'; ++at) options.files.emplace_back(argv[at]);
  try {
    app.parse(argc - at + 1, argv + at - 1);
    options.output = default_scene(options);
    constexpr const char* asking[] = {"--scale",   "--edge", "--tissue", "--hold",
                                      "--springs", "--pin",  "--voxels", "--accept-loss"};
    const bool asks = std::any_of(std::begin(asking), std::end(asking),
                                  [&](const char* name) { return app.count(name) > 0; });
    if (!asks && std::filesystem::exists(options.output))
      std::printf("%s was made before; remove it, or give --tissue, --hold or another choice, for another\n",
                  options.output.string().c_str());
    else
      make_scene(options, &warnings);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {
    print_errors(error.what());
    return bad_input;
  }
  std::vector<std::string> words{options.output.string()};
  for (const auto& file : options.files)
    words.push_back("--made-from=" + std::filesystem::absolute(file).string());
  for (const std::string& warning : warnings) words.push_back("--made-warning=" + warning);
  if (options.scale > 0) words.push_back("--made-scale=" + lobe::exact(options.scale));
  for (const std::string& word : app.remaining()) words.push_back(word);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  return forward("lobe-view", arguments.data(), arguments.data() + arguments.size(), "LOBE_VIEW");
}

// lobe-petsc has options of its own, so that it reads all of them.
bool is_for_petsc(int argc, char** argv) {
  if (argc < 2 || std::string_view(argv[1]) != "solve") return false;
  for (int i = 2; i < argc; ++i) {
    const std::string_view word = argv[i], before = argv[i - 1];
    if (word == "--solver=petsc" || (before == "--solver" && word == "petsc")) return true;
  }
  return false;
}

// A command that another program answers with the arguments after it; nothing for the commands of `lobe`
// itself.
std::optional<int> run_other_program(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  if (command == "mesh") return forward("lobe-mesh", argv + 2, argv + argc, "LOBE_MESHING");
  if (command == "bench") return forward("lobe-bench", argv + 2, argv + argc, "LOBE_BENCHMARKS");
  const bool is_scene = argc > 2 && std::filesystem::path(argv[2]).extension() == ".json";
  if (command == "view" && argc > 2 && argv[2][0] != '-' && !is_scene) return make_and_view(argc, argv);
  if (command == "view") return forward("lobe-view", argv + 2, argv + argc, "LOBE_VIEW");
  if (is_for_petsc(argc, argv)) return forward("lobe-petsc", argv + 1, argv + argc, "LOBE_PETSC");
  return {};
}

void add_info(CLI::App& app, InfoOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("info", "Counts, labels, quality, volume, stable time step of a mesh");
  command->add_option("MESH", options.mesh, "vtu, vtk, msh, mesh, node/ele")->required();
  command->add_option("--lambda", options.lame_lambda, "Lamé λ for the time step [Pa]")
      ->capture_default_str();
  command->add_option("--mu", options.lame_mu, "Lamé μ for the time step [Pa]")->capture_default_str();
  command->add_option("--density", options.density, "for the time step [kg/m³]")->capture_default_str();
  command->add_flag("--json", options.json, "print only JSON");
  command->callback([&] { action = [&] { return info(options); }; });
}

void add_compare(CLI::App& app, CompareOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("compare", "Norms of the difference of two displacement fields");
  command->add_option("A", options.a, "mesh with point data \"displacement\" (.vtu)")->required();
  command->add_option("B", options.b, "the reference, on the same mesh or another of the same body")
      ->required();
  command->add_flag("--json", options.json, "print only JSON");
  command->callback([&] { action = [&] { return compare(options); }; });
}

void add_refine(CLI::App& app, RefineOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("refine", "Cut each tetrahedron of a mesh into eight");
  command->add_option("MESH", options.mesh, "vtu, vtk, msh, mesh, node/ele")->required();
  command->add_option("-o,--output", options.output, "mesh to write; .vtu keeps the arrays of a .vtu")
      ->required();
  CLI::Option* times = command->add_option("--times", options.times, "how often")
                           ->check(CLI::Range(1, 10))
                           ->capture_default_str();
  command->add_option("--tets", options.tets, "in place of --times: until there are so many")
      ->check(CLI::Range(1LL, 2'000'000'000LL))
      ->excludes(times);
  command->callback([&] { action = [&] { return refine(options); }; });
}

void add_convert(CLI::App& app, ConvertOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("convert", "Write a mesh in another format, or in metres");
  command->add_option("MESH", options.mesh, "vtu, vtk, msh, mesh, node/ele")->required();
  command->add_option("-o,--output", options.output, "mesh to write; .vtu keeps the arrays of a .vtu")
      ->required();
  command->add_option("--scale", options.scale, "what coordinates are multiplied by: 0.001 from millimetres")
      ->check(CLI::Range(1e-9, 1e9))
      ->capture_default_str();
  command->add_option("--labels", options.labels, "cell array of a .vtu or .vtk that has the labels");
  command->callback([&] { action = [&] { return convert(options); }; });
}

void add_scene(CLI::App& app, MakeSceneOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("scene", "Write a scene for a mesh or a surface: units, tissue, what is held");
  command->add_option("FILE", options.files, "a mesh, a label image, or surfaces")->required();
  add_make_scene_options(*command, options);
  command->add_option("-o,--output", options.output, "scene to write (.json); default: FILE_scene.json");
  command->callback([&] { action = [&] { return make_scene(options); }; });
}

void add_tissues(CLI::App& app, TissuesOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("tissues", "Organs, tissues and phantoms that a material may be named after");
  command->add_flag("--json", options.json, "print only JSON");
  command->callback([&] { action = [&] { return print_tissues(options); }; });
}

void add_rest(CLI::App& app, RestOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("rest", "The unloaded shape of a body that is given under its loads");
  command->add_option("SCENE", options.scene, "scene file, whose mesh is the loaded shape")->required();
  command->add_option("--mesh", options.mesh, "mesh to use in place of the scene's");
  command
      ->add_option("-o,--output", options.output,
                   "scene to write (.json, with its mesh beside it), or the mesh alone (.vtu)")
      ->required();
  command->add_option("--tolerance", options.tolerance, "how near the loaded shape must come to the mesh [m]")
      ->check(CLI::Range(1e-12, 1.0))
      ->capture_default_str();
  command->add_flag("--json", options.json, "print only JSON");
  command->callback([&] { action = [&] { return rest(options); }; });
}

void add_fit(CLI::App& app, FitCommand& fit_command, Action& action) {
  CLI::App* command =
      app.add_subcommand("fit", "Parameters of materials from measured displacements, forces, frequencies");
  command->add_option("SCENE", fit_command.scenes, "scene file; several for several loads")->required();
  command
      ->add_option("--to", fit_command.data,
                   "table of measurements (.csv), one for each scene; with times it is of its motion")
      ->required();
  command
      ->add_option("--parameters", fit_command.parameters,
                   "what is searched: MATERIAL.young_modulus, .poisson_ratio, .density, .stiffness, "
                   ".prony_shear_1, .prony_time_1, attachments.NAME.stiffness, damping, …")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("-o,--output", fit_command.output, "scene to write with what was found (.json)");
  command->add_flag("--json", fit_command.json, "print only JSON");
  command->callback([&] { action = [&] { return fit(fit_command); }; });
}

void add_sensitivity(CLI::App& app, SensitivityCommand& options, Action& action) {
  CLI::App* command = app.add_subcommand(
      "sensitivity", "Which material, held part or model moves the sag and the forces of a scene most");
  command->add_option("SCENE", options.scene, "scene file")->required();
  command->add_option("-o,--output", options.output,
                      "mesh to write with the share of each tetrahedron (.vtu)");
  command->add_option("--picture", options.picture, "picture of it (.png); needs -o");
  command->add_flag("--json", options.json, "print only JSON");
  command->callback([&] { action = [&] { return sensitivity(options); }; });
}

CLI::App* add_scene_command(CLI::App& app, const char* name, const char* help, SceneOptions& options,
                            Action& action, int (*function)(const SceneOptions&)) {
  CLI::App* command = app.add_subcommand(name, help);
  command->add_option("SCENE", options.scene, "scene file (docs/scene.md)")->required();
  command->add_option("--mesh", options.mesh, "mesh to use in place of the scene's");
  command->callback(
      [&options, &action, function] { action = [&options, function] { return function(options); }; });
  return command;
}

void add_solver(CLI::App* command, SceneOptions& options, const std::vector<std::string>& solvers) {
  command
      ->add_option("--solver", options.solver,
                   "sparse solver: eigen, or a program of its own: cholmod (GPL), petsc (under mpirun)")
      ->check(CLI::IsMember(solvers))
      ->capture_default_str();
}

// CLI11 would only say that a command is missing, and not that there is none of this name.
void refuse_unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  const bool option = word.empty() || word.front() == '-';
  if (option || std::find(known.begin(), known.end(), word) != known.end()) return;
  const std::string near = lobe::nearest_word(word, known);
  const std::string guess = near.empty() ? "" : "; did you mean \"" + near + "\"?";
  throw lobe::InputError(word, "is no command" + guess + " (lobe --help lists them)");
}

void add_threads(CLI::App* command, SceneOptions& options) {
  command->add_option("--threads", options.threads, "threads of the simulation")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void add_run(CLI::App& app, SceneOptions& options, Action& action) {
  CLI::App* run_command =
      add_scene_command(app, "run", "Play a scene: frames, pictures, report", options, action, run);
  run_command->add_option("-o,--output", options.output, "directory for the results")->required();
  add_threads(run_command, options);
  run_command->add_flag("--no-pictures", options.no_pictures, "do not render pictures");
  run_command->add_option("--record", options.record, "file to record the run in, for `replay`");
  run_command->add_flag("--json", options.json, "print only the report");
  CLI::App* replay_command = add_scene_command(
      app, "replay", "Play a recording again and compare it, bit by bit", options, action, replay);
  replay_command->add_option("RECORDING", options.record, "what `run --record` wrote")->required();
  add_threads(replay_command, options);
}

}  // namespace

int main(int argc, char** argv) {
  take_utf8_arguments(argc, argv);
  if (const std::optional<int> status = run_other_program(argc, argv)) return *status;
  CLI::App app{"Hybrid linear / non-linear organ models in real time"};
  app.allow_windows_style_options(false);  // a file may be /home/scene.json there, too
  app.require_subcommand(1);
  app.set_version_flag("--version", LOBE_VERSION);
  Action action;
  InfoOptions info_options;
  SceneOptions options;
  app.add_subcommand("mesh", "From a surface to a mesh: runs lobe-mesh");
  app.add_subcommand("bench", "Measure speed, accuracy and correctness: runs lobe-bench");
  app.add_subcommand("view", "Simulate an organ live, in a web page: a scene, or a mesh or surface");
  add_info(app, info_options, action);
  CLI::App* check_command =
      add_scene_command(app, "check", "Validate a scene and print what will be run", options, action, check);
  check_command->add_flag("--json", options.json, "print only JSON");
  check_command->add_flag("--total-error", options.total_error,
                          "also how far this mesh is from quadratic tetrahedra on it, for its gestures");
  add_solver(check_command, options, {"eigen", "cholmod"});
  add_run(app, options, action);
  CLI::App* solve_command =
      add_scene_command(app, "solve", "Static equilibrium of a scene", options, action, solve);
  solve_command->add_option("-o,--output", options.output, "directory for the results")->required();
  solve_command->add_flag("--json", options.json, "print only the report");
  solve_command->add_flag("--quadratic", options.quadratic, "with 10-node tetrahedra on the same mesh");
  add_solver(solve_command, options, {"eigen", "cholmod", "petsc"});
  RestOptions rest_options;
  add_rest(app, rest_options, action);
  FitCommand fit_command;
  add_fit(app, fit_command, action);
  SensitivityCommand sensitivity_command;
  add_sensitivity(app, sensitivity_command, action);
  CompareOptions compare_options;
  add_compare(app, compare_options, action);
  RefineOptions refine_options;
  add_refine(app, refine_options, action);
  ConvertOptions convert_options;
  add_convert(app, convert_options, action);
  MakeSceneOptions make_scene_options;
  add_scene(app, make_scene_options, action);
  TissuesOptions tissues_options;
  add_tissues(app, tissues_options, action);
  CLI::App* regions_command =
      add_scene_command(app, "regions", "Write the mesh with its region tags", options, action, regions);
  regions_command->add_option("-o,--output", options.output, "mesh to write (.vtu)")->required();
  regions_command->add_option("--picture", options.picture, "picture of the regions to draw (.png)");

  try {
    if (argc > 1) refuse_unknown_command(app, argv[1]);
    app.parse(argc, argv);
    if (options.solver == "cholmod" && linked_solver.name != options.solver)
      return forward("lobe-cholmod", argv + 1, argv + argc, "LOBE_CHOLMOD");
    return action();
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {
    print_errors(error.what());
  }
  return bad_input;
}
