// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// lobe-mesh: from surface models to tetrahedra. Exit status: 0 done, 1 a mesher gave up or the mesh lacks a
// label, 2 bad input.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/io/surface_io.h"
#include "lobe/text.h"
#include "lobe_mesh/body_size.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/picture.h"
#include "lobe_mesh/report_json.h"
#include "lobe_mesh/segment_names.h"
#include "lobe_mesh/shared_walls.h"
#include "lobe_mesh/surface_groups.h"
#include "lobe_mesh/voxels.h"
#include "mesh_options.h"
#include "progress_line.h"

namespace {

using namespace lobe;
using namespace lobe::meshing;

void warn(const std::string& message) {
  std::cerr << line_eraser() << "lobe-mesh: warning: " << message << "\n";
}

void print_errors(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    std::cerr << line_eraser() << "lobe-mesh: error: " << line << "\n";
}

void say(const Options& o, const std::string& text) {
  if (!o.quiet) std::cerr << line_eraser() << text;
}

constexpr double largest_organ = 2;  // [m] across

void warn_of_size(double diagonal) {
  if (diagonal > largest_organ)
    warn("the body is " + rounded(diagonal) + " m large: if the file is in millimetres, use --scale 0.001");
}

RepairReport repair(const std::string& file, const Options& o, Surface& surface) {
  RepairReport result;
  try {
    surface = repair_surface(surface, o.repair, result);
  } catch (const InputError& error) {
    std::vector<Fault> faults = error.faults();
    for (Fault& fault : faults) fault.place = file + ": " + fault.place;
    throw InputError(std::move(faults));
  }
  for (const RepairStep& step : result.steps) say(o, "repair: " + step.in_words() + "\n");
  for (const std::string& warning : result.warnings) warn(warning);
  warn_of_size(box_diagonal(surface));
  return result;
}

// The scale of a body of that size in the units of its file.
double scale_by_size(double diagonal, const std::string& why) {
  if (!(diagonal > largest_organ)) return 1;
  warn(why + "the body is " + rounded(diagonal) +
       " m large: it is taken to be in millimetres (--scale 1 if not)");
  return 0.001;
}

// What --find-units makes of the size of surfaces: reads them once more.
double found_scale(const Options& o) {
  double diagonal = 0;
  for (const std::string& file : o.surfaces) diagonal = std::max(diagonal, box_diagonal(read_surface(file)));
  return scale_by_size(diagonal, "");
}

// Of what read_label_image() returns. Where the file names no unit and none was asked for, the size of the
// body says whether it is in millimetres.
double scale_of(const Options& o, const LabelImage& image) {
  const double unit = image.assumed_unit;
  if (o.has_scale) return unit > 0 ? o.scale / unit : o.scale;
  if (unit == 0) return o.find_units ? scale_by_size(body_diagonal(image), "") : 1;
  if (unit < 1) {
    warn("no unit is named: a segmentation of 3D Slicer is taken to be in millimetres (--scale 1 if not)");
    return 1;
  }
  const double scale = scale_by_size(body_diagonal(image), "no unit is named, and ");
  if (scale == 1) say(o, "no unit is named: it is taken to be in metres (--scale 0.001 for millimetres)\n");
  return scale;
}

Surface scaled_surface(const std::string& file, const Options& o) {
  Surface surface = read_surface(file);
  surface.points *= o.scale;
  return surface;
}

int print_diagnosis(const Options& o, const Surface& surface) {
  const Diagnosis diagnosis = diagnose(surface);
  if (!o.marked.empty()) write_marked(o.marked, surface, diagnosis);
  std::cout << (o.json ? in_json(diagnosis) + "\n" : in_words(diagnosis));
  return 0;
}

// Coordinates are those of the file, also where they are taken for millimetres.
int print_size(const Options& o) {
  const auto scale = [&](const BodySize& body, double found) {
    return o.has_scale ? o.scale : body.size.norm() * found > largest_organ ? 0.001 * found : found;
  };
  BodySize body;
  double found = 1;
  if (o.is_image()) {
    LabelImage image = read_label_image(o.surfaces.front());
    if (image.assumed_unit > 0) found = image.assumed_unit;
    image.to_world /= found;
    body = size_of(image);
  } else {
    std::vector<Surface> surfaces;
    for (const std::string& file : o.surfaces) surfaces.push_back(read_surface(file));
    body = size_of(surfaces, o.mesh.cavities);
  }
  std::cout << in_json(body, scale(body, found)) << "\n";
  return 0;
}

std::vector<Surface> repaired_surfaces(const Options& o, std::vector<InputFile>& inputs) {
  std::vector<Surface> surfaces;
  for (const std::string& file : o.surfaces) {
    Surface surface = scaled_surface(file, o);
    say(o, file + ": " + std::to_string(surface.triangle_count()) + " triangles\n");
    o.mesh.progress("repair", -1);
    inputs.push_back({file, repair(file, o, surface)});
    surfaces.push_back(std::move(surface));
  }
  if (!o.repaired.empty()) write_surface(o.repaired, surfaces[0].points, surfaces[0].triangles);
  return surfaces;
}

void write_report(const Options& o, const std::string& json) {
  if (!o.report.empty()) io::write_file(o.report, json + "\n");
  if (o.json) std::cout << json << "\n";
}

int repair_only(const Options& o) {
  std::vector<InputFile> inputs;
  const Surface surface = repaired_surfaces(o, inputs).front();
  write_report(o, in_json(inputs.front()));
  say(o, "repaired: " + std::to_string(surface.triangle_count()) + " triangles around " +
             rounded(enclosed_volume(surface)) + " m³\n");
  return 0;
}

TetMesh mesh_surfaces(const Options& o, std::vector<InputFile>& inputs, MeshReport& report) {
  const std::vector<Surface> surfaces = repaired_surfaces(o, inputs);
  if (o.voxels > 0) return tetrahedralise_voxels(surfaces, o.voxels, o.mesh, report);
  try {
    return tetrahedralise(surfaces, o.mesh, report);
  } catch (const SurfacesTouch& error) {
    if (!o.find_voxels) throw;
    const Fault& fault = error.faults().front();
    const double edge = o.mesh.edge > 0 ? o.mesh.edge : default_edge(surfaces), longest = edge / 3,
                 keeping =
                     voxels_that_keep(surfaces, longest, o.mesh.cavities, Winner::smaller, o.mesh.smoothing),
                 voxel = keeping > 0 ? keeping : longest;
    warn(fault.place + " " + fault.message.substr(0, fault.message.find(':')) +
         ": all are turned into voxels of " + rounded(voxel) + " m" +
         (voxel < longest ? ", which keep what is thin in them" : "") +
         ", of which the smaller surface wins");
    return tetrahedralise_voxels(surfaces, voxel, o.mesh, report, Winner::smaller);
  }
}

TetMesh mesh_image(const Options& o, std::vector<InputFile>& inputs, MeshReport& report) {
  const std::string& file = o.surfaces.front();
  LabelImage image = read_label_image(file);
  image.to_world *= scale_of(o, image);
  std::ostringstream text;
  text << file << ": " << image.size[0] << " × " << image.size[1] << " × " << image.size[2] << " voxels of "
       << image.to_world.leftCols<3>().colwise().norm() << " m\n";
  say(o, text.str());
  inputs.push_back({file, {}});
  TetMesh mesh = tetrahedralise(image, o.mesh, report);
  warn_of_size((report.quality.box_max - report.quality.box_min).norm());
  return mesh;
}

// Names of the labels: of segments of an image, or of the files of several surfaces, where these differ.
std::map<int, std::string> names_of_labels(const Options& o) {
  std::map<int, std::string> names;
  if (o.is_image()) return segment_names(o.surfaces.front());
  std::set<std::string> different;
  const std::size_t count = o.surfaces.size() - o.voids.size();
  for (std::size_t k = 0; k < count; ++k) {
    names[static_cast<int>(k)] = std::filesystem::path(o.surfaces[k]).stem().string();
    different.insert(names[static_cast<int>(k)]);
  }
  return count > 1 && different.size() == count ? names : std::map<int, std::string>{};
}

std::vector<SurfaceGroup> groups_of(const Options& o, const TetMesh& mesh) {
  std::vector<NamedSurface> groups;
  bool any = false;
  for (const std::string& file : o.surfaces)
    for (NamedSurface& group : read_groups(file)) {
      any |= !group.name.empty();
      group.surface.points *= o.scale;
      if (!group.name.empty() && o.surfaces.size() > 1)
        group.name = std::filesystem::path(file).stem().string() + ": " + group.name;
      groups.push_back(std::move(group));
    }
  return any ? groups_of_faces(mesh, groups) : std::vector<SurfaceGroup>{};
}

// With the groups of the surfaces and the names of the labels, where the format holds them.
void write_with_groups(const Options& o, const TetMesh& mesh, const std::map<int, std::string>& label_names) {
  Groups groups{o.is_image() ? std::vector<SurfaceGroup>{} : groups_of(o, mesh), {}};
  for (const int label : mesh.labels)
    if (const auto name = label_names.find(label); name != label_names.end())
      groups.label_names.insert(*name);
  std::string names;
  for (const SurfaceGroup& group : groups.surfaces) names += (names.empty() ? "" : ", ") + group.name;
  const bool holds = holds_groups(o.output);
  if (!names.empty() && !holds)
    warn("the groups of the surface (" + names +
         ") are left out: -o MESH.vtu or MESH.msh keeps them, for a scene to select");
  else if (!names.empty())
    say(o, "groups of the surface: " + names + "\n");
  if (o.is_image() && !groups.label_names.empty() && !holds)
    warn("the names of the segments are left out: -o MESH.vtu or MESH.msh keeps them");
  write_grouped_mesh(o.output, mesh, holds ? groups : Groups{});
}

// The mesh is written already when a picture fails, so this failure is reported separately.
int draw(const Options& o, const TetMesh& mesh, const MeshReport& report) {
  o.mesh.progress("picture", -1);
  const std::string failure = draw_picture(o.picture, mesh, report);
  if (failure.empty()) return 0;
  std::cerr << "lobe-mesh: error: --picture: " << failure << "\n";
  return 1;
}

// Whether the mesh is no success, since it has lost a label, or too much of one. Then it is said.
bool says_loss(const MeshReport& report) {
  const double lost = report.lost_volume();
  if (report.missing_labels() > 0)
    print_errors("the mesh lacks a label of the input: choose a shorter edge for it, as the warning says");
  else if (lost > quality_gate.lost_volume)
    print_errors("the mesh has lost " + rounded(std::round(lost)) +
                 " % of a label's volume: choose a shorter edge, as the warning says, or --accept-loss");
  return report.missing_labels() > 0 || lost > quality_gate.lost_volume;
}

int run(const Options& given) {
  if (given.measure) return print_size(given);
  Options o = given;
  if (o.find_units && !o.is_image()) o.scale = found_scale(o);
  if (o.diagnose) return print_diagnosis(o, scaled_surface(o.surfaces.front(), o));
  if (o.output.empty()) return repair_only(o);
  std::vector<InputFile> inputs;
  MeshReport report;
  const TetMesh mesh = o.is_image() ? mesh_image(o, inputs, report) : mesh_surfaces(o, inputs, report);
  for (const std::string& warning : report.warnings) warn(warning);
  write_with_groups(o, mesh, names_of_labels(o));
  write_report(o, in_json(inputs, o.output, o.mesh, report));
  say(o, in_words(report));
  if (!o.mesh.accepts_loss && says_loss(report)) return 1;
  return o.picture.empty() ? 0 : draw(o, mesh, report);
}

// Ends the run some seconds after the time limit. The meshers observe the limit themselves; this is for all
// other work.
void limit_time(double seconds) {
  std::signal(SIGALRM, [](int) {
    static constexpr char message[] =
        "lobe-mesh: error: the time limit is over: try the other --mesher, --repair wrap or a longer "
        "--time-limit\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, message, sizeof message - 1);
    _exit(1);
  });
  if (seconds > 0 && seconds < 1e7) alarm(static_cast<unsigned>(std::ceil(seconds)) + 3);
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
    const bool is_empty = *error.what() == '\0';
    print_errors(is_empty ? "a library gave up and does not say why: try the other --mesher, or --repair wrap"
                          : error.what());
    return 1;
  }
}

// Removes the half-written files that a killed process has left in the folders of its outputs.
void remove_parts(const Options& o, int process) {
  for (const std::string& output : o.outputs()) {
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

ChildResult run_watched(Options options) {
  ProgressLine line(!options.quiet && isatty(STDERR_FILENO) != 0);
  options.mesh.progress = [&](const std::string& phase, double done) { line.report(phase, done); };
  return run_contained([&] { return run_and_report(options); }, options.mesh.memory_limit,
                       [&] { line.draw(); });
}

// A copy of this process with a separate temporary folder does the work. So a crash inside a geometry library
// becomes a message, and a cancelled run leaves nothing behind.
int run_safely(const Options& options) {
  const TemporaryFolder folder;
  setenv("TMPDIR", folder.path().c_str(), 1);
  const ChildResult result = run_watched(options);
  if (result.end == ChildResult::End::normal) return result.status;
  remove_parts(options, result.process);
  const bool cancelled = result.status == SIGINT || result.status == SIGTERM || result.status == SIGHUP;
  print_errors(cancelled ? "cancelled"
                         : "the run " + result.in_words() + ": try the other --mesher, or --repair wrap");
  return cancelled ? 128 + result.status : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("From surface models to tetrahedra: repair, mesh, report quality and stable time step.",
               "lobe-mesh");
  Options options;
  declare_options(app, options);
  try {
    app.parse(argc, argv);
    check_options(app, options);
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
