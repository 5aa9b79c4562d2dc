// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// lobe-mesh: from surface models to tetrahedra. Exit status: 0 done, 1 a mesher gave up, 2 bad input.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>

#include <unistd.h>

#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/repair.h"
#include "lobe_mesh/report_json.h"
#include "lobe_mesh/surface.h"
#include "lobe_mesh/tetrahedralise.h"

namespace {

using namespace lobe;
using namespace lobe::meshing;

struct Options {
  std::vector<std::string> surfaces;
  std::string output, report, marked;
  std::vector<std::string> label_edges, balls;
  double scale = 1;
  bool diagnose = false, json = false, quiet = false;
  RepairOptions repair;
  MeshOptions mesh;
};

// An option whose value is one of a few words.
template <class Value>
void add_choice(CLI::App& app, const std::string& name, Value& value,
                const std::map<std::string, Value>& words, const std::string& help) {
  app.add_option_function<std::string>(
      name,
      [name, &value, &words](const std::string& word) {
        const auto found = words.find(word);
        if (found == words.end()) {
          std::string known;
          for (const auto& [other, ignored] : words) known += (known.empty() ? "" : ", ") + other;
          throw CLI::ValidationError(name, word + ", expected one of " + known);
        }
        value = found->second;
      },
      help);
}

void declare(CLI::App& app, Options& o) {
  static const std::map<std::string, Mesher> meshers{{"cgal", Mesher::cgal}, {"tetgen", Mesher::tetgen}};
  static const std::map<std::string, Repair> levels{
      {"none", Repair::none}, {"basic", Repair::basic}, {"wrap", Repair::wrap}};
  app.add_option(
         "SURFACE", o.surfaces,
         "closed surfaces: .stl, .obj, .ply, .off or .vtp; the first is label 0, the next 1 …, one within "
         "another or apart")
      ->required();
  app.add_option("-o,--output", o.output,
                 "mesh to write: .vtu, .vtk, .msh (4.1), .msh2 (2.2), .mesh or .node");
  app.add_flag("--diagnose", o.diagnose, "only say what is wrong with the surface");
  app.add_option("--marked", o.marked, "file for the surface with its faults as cell data: .vtp");
  app.add_option("--edge", o.mesh.edge, "edge of the tetrahedra [m]; default: diagonal / 25");
  app.add_option("--label-edge", o.label_edges, "LABEL=EDGE: another edge in one label [m]; can be repeated");
  app.add_option("--ball", o.balls, "X,Y,Z,RADIUS,EDGE: shorter edges in a ball [m]; can be repeated");
  app.add_option("--growth", o.mesh.growth, "of the edge per distance, where it changes")
      ->capture_default_str();
  app.add_option("--scale", o.scale, "factor on the coordinates, 0.001 for millimetres")
      ->capture_default_str();
  add_choice(app, "--mesher", o.mesh.mesher, meshers, "cgal (default) or tetgen (keeps creases)");
  add_choice(app, "--repair", o.repair.level, levels, "none, basic (default) or wrap (last resort)");
  app.add_option("--largest-hole", o.repair.largest_hole,
                 "widest hole that is filled, of the surface's diagonal")
      ->capture_default_str();
  app.add_option("--wrap-alpha", o.repair.wrap_alpha,
                 "gaps that wrapping bridges [m]; default: diagonal / 60");
  app.add_option("--wrap-offset", o.repair.wrap_offset, "distance of the wrapping [m]; default: alpha / 30");
  app.add_option("--tries", o.mesh.tries, "meshes to choose the best from")->capture_default_str();
  app.add_option("--feature-angle", o.mesh.feature_angle, "edges that turn by more stay sharp [degrees]")
      ->capture_default_str();
  app.add_option("--time-limit", o.mesh.time_limit, "for the whole run [s]")->capture_default_str();
  app.add_option("--memory-limit", o.mesh.memory_limit, "for the run, and for TetGen [bytes]")
      ->capture_default_str();
  app.add_option("--lambda", o.mesh.lambda, "of the reported time step [Pa]")->capture_default_str();
  app.add_option("--mu", o.mesh.mu, "of the reported time step [Pa]")->capture_default_str();
  app.add_option("--density", o.mesh.density, "of the reported time step [kg/m³]")->capture_default_str();
  app.add_option("--report", o.report, "file for the report (JSON)");
  app.add_flag("--json", o.json, "the report alone on standard output");
  app.add_flag("--quiet", o.quiet, "no progress on standard error");
}

void check(const CLI::App& app, const Options& o) {
  std::vector<Fault> faults;
  if (o.surfaces.size() > 1 && o.diagnose) faults.push_back({"--diagnose", "looks at one surface at a time"});
  if (!o.diagnose && o.output.empty())
    faults.push_back({"--output", "missing: give -o MESH.vtu (or --diagnose)"});
  const std::filesystem::path output(o.output), folder = output.parent_path();
  if (!o.output.empty() && !can_write_mesh(output)) {
    faults.push_back(
        {"--output", o.output + ": expected a name that ends in .vtu, .vtk, .msh, .msh2, .mesh or .node"});
  }
  if (!o.marked.empty() && !o.diagnose) faults.push_back({"--marked", "belongs to --diagnose"});
  if (!o.marked.empty() && std::filesystem::path(o.marked).extension() != ".vtp")
    faults.push_back({"--marked", o.marked + ": expected a name that ends in .vtp"});
  for (const std::filesystem::path& file :
       {output, std::filesystem::path(o.report), std::filesystem::path(o.marked)}) {
    if (file.has_parent_path() && !std::filesystem::is_directory(file.parent_path())) {
      faults.push_back({file.string(), "there is no folder " + file.parent_path().string()});
    }
  }
  if (!o.report.empty()) {
    const std::filesystem::path report(o.report);
    if (report.lexically_normal() == output.lexically_normal())
      faults.push_back({"--report", o.report + ": is the name of the mesh too"});
    if (std::filesystem::is_directory(report)) faults.push_back({"--report", o.report + ": is a folder"});
  }
  if (!o.output.empty() && std::filesystem::is_directory(output))
    faults.push_back({"--output", o.output + ": is a folder"});
  const auto positive = [&](const char* name, double value) {
    if (app.count(name) > 0 && !(std::isfinite(value) && value > 0)) {
      faults.push_back({name, "must be a positive number"});
    }
  };
  positive("--edge", o.mesh.edge);
  positive("--scale", o.scale);
  positive("--largest-hole", o.repair.largest_hole);
  positive("--wrap-alpha", o.repair.wrap_alpha);
  positive("--wrap-offset", o.repair.wrap_offset);
  if (!faults.empty()) throw InputError(std::move(faults));
}

void warn(const std::string& message) { std::cerr << "lobe-mesh: warning: " << message << "\n"; }

void write_text(const std::filesystem::path& file, const std::string& text) {
  io::AtomicFile out(file);
  out.stream() << text << "\n";
  out.commit();
}

// "1=0.004" and "0.1,0,0.02,0.03,0.004": numbers with one separator each.
std::vector<double> numbers_of(const std::string& option, std::string text, const std::string& form) {
  const auto count = static_cast<std::size_t>(std::count(form.begin(), form.end(), ',') + 1);
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    std::size_t end = 0;
    try {
      numbers.push_back(std::stod(word, &end));
    } catch (const std::exception&) {
    }
    if (end == 0 || end != word.size()) throw InputError(option, text + ", expected " + form);
  }
  if (numbers.size() != count) throw InputError(option, text + ", expected " + form);
  return numbers;
}

void read_sizing(Options& o) {
  for (std::string text : o.label_edges) {
    std::replace(text.begin(), text.end(), '=', ',');
    const std::vector<double> n = numbers_of("--label-edge", text, "LABEL,EDGE");
    if (n[0] != std::round(n[0]) || std::abs(n[0]) > 1e6)
      throw InputError("--label-edge", text + ", expected a whole label");
    o.mesh.label_edges[static_cast<int>(n[0])] = n[1];
  }
  for (const std::string& text : o.balls) {
    const std::vector<double> n = numbers_of("--ball", text, "X,Y,Z,RADIUS,EDGE");
    o.mesh.balls.push_back({{n[0], n[1], n[2]}, n[3], n[4]});
  }
}

RepairedFile repair(const std::string& file, const Options& o, Surface& surface) {
  RepairedFile result{file, {}};
  try {
    surface = repair_surface(surface, o.repair, result.repair);
  } catch (const InputError& error) {
    std::vector<Fault> faults = error.faults();
    for (Fault& fault : faults) fault.place = file + ": " + fault.place;
    throw InputError(std::move(faults));
  }
  if (!o.quiet) {
    for (const RepairStep& step : result.repair.steps) std::cerr << "repair: " + step.message + "\n";
  }
  for (const std::string& warning : result.repair.warnings) warn(warning);
  if (box_diagonal(surface) > 2) {
    std::ostringstream text;
    text << "the body is " << box_diagonal(surface)
         << " m large: if the file is in millimetres, use --scale 0.001";
    warn(text.str());
  }
  return result;
}

int print_diagnosis(const Options& o, const Surface& surface) {
  const Diagnosis diagnosis = diagnose(surface);
  if (!o.marked.empty()) write_marked(o.marked, surface, diagnosis);
  std::cout << (o.json ? in_json(diagnosis) + "\n" : in_words(diagnosis));
  return 0;
}

int run(const Options& o) {
  const auto say = [&](const std::string& text) {
    if (!o.quiet) std::cerr << text;
  };
  std::vector<Surface> surfaces;
  std::vector<RepairedFile> repaired;
  for (const std::string& file : o.surfaces) {
    Surface surface = read_surface(file);
    surface.points *= o.scale;
    if (o.diagnose) return print_diagnosis(o, surface);
    say(file + ": " + std::to_string(surface.triangle_count()) + " triangles\n");
    repaired.push_back(repair(file, o, surface));
    surfaces.push_back(std::move(surface));
  }
  say("meshing…\n");
  MeshReport report;
  const TetMesh mesh = tetrahedralise(surfaces, o.mesh, report);
  for (const std::string& warning : report.warnings) warn(warning);
  write_mesh(o.output, mesh);
  const std::string json = in_json(repaired, o.output, o.mesh, report);
  if (!o.report.empty()) write_text(o.report, json);
  if (o.json) std::cout << json << "\n";
  say(in_words(report));
  return 0;
}

// The meshers keep the time limit themselves; this is for everything else, some seconds later.
void limit_time(double seconds) {
  std::signal(SIGALRM, [](int) {
    static constexpr char message[] =
        "lobe-mesh: error: the time limit is over: choose a longer --time-limit\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, message, sizeof message - 1);
    _exit(1);
  });
  if (seconds > 0 && seconds < 1e7) alarm(static_cast<unsigned>(std::ceil(seconds)) + 3);
}

void print_errors(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) std::cerr << "lobe-mesh: error: " << line << "\n";
}

// Every error becomes one line and an exit status.
int run_and_report(const Options& options) {
  try {
    limit_time(options.mesh.time_limit);
    return run(options);
  } catch (const InputError& error) {
    print_errors(error.what());
    return 2;
  } catch (const MeshingFailure& failure) {
    print_errors(failure.what());
    return 1;
  } catch (const std::bad_alloc&) {
    print_errors("out of memory: choose a longer --edge, or a larger --memory-limit");
    return 1;
  } catch (const std::exception& error) {
    print_errors(error.what());
    return 1;
  }
}

// What a process that was killed left half written beside its outputs.
void remove_parts(const Options& o, int process) {
  for (const std::string& output : {o.output, o.report, o.marked}) {
    const std::filesystem::path file(output);
    const std::string begin = file.stem().string(), middle = "." + std::to_string(process) + "-";
    std::error_code ignored;
    const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    if (output.empty()) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(begin) && name.ends_with(".part") && name.find(middle) != name.npos)
        std::filesystem::remove(entry.path(), ignored);
    }
  }
}

// The work is done by a copy of this process with a temporary folder of its own, so that a crash inside a
// geometry library is a message, and a cancelled run leaves nothing behind.
int run_safely(const Options& options) {
  const TemporaryFolder folder;
  setenv("TMPDIR", folder.path().c_str(), 1);
  const ChildResult result =
      run_contained([&] { return run_and_report(options); }, options.mesh.memory_limit);
  if (result.end == ChildResult::End::normal) return result.status;
  remove_parts(options, result.process);
  const bool cancelled = result.status == SIGINT || result.status == SIGTERM;
  print_errors(cancelled ? "cancelled"
                         : "the run " + result.in_words() + ": try the other --mesher, or --repair wrap");
  return cancelled ? 128 + result.status : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("From surface models to tetrahedra: repair, mesh, report quality and stable time step.",
               "lobe-mesh");
  Options options;
  declare(app, options);
  try {
    app.parse(argc, argv);
    check(app, options);
    read_sizing(options);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    print_errors(error.what());
    return 2;
  } catch (const InputError& error) {
    print_errors(error.what());
    return 2;
  }
  return run_safely(options);
}
