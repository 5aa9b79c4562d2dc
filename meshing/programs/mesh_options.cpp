// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "mesh_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe_mesh/size_balls.h"

namespace lobe::meshing {
namespace {

void expect_ending(const std::string& option, const std::string& file,
                   const std::vector<std::string>& endings, std::vector<Fault>& faults) {
  if (file.empty()) return;
  std::string known;
  for (const std::string& ending : endings) {
    if (std::filesystem::path(file).extension() == ending) return;
    known += (known.empty() ? "" : &ending == &endings.back() ? " or " : ", ") + ending;
  }
  faults.push_back({option, file + ": expected a name that ends in " + known});
}

void check_image(const CLI::App& app, const Options& o, std::vector<Fault>& faults) {
  const auto only_for = [&](bool wrong, const std::string& option, const std::string& input) {
    if (wrong && app.count(option) > 0) faults.push_back({option, "belongs to " + input});
  };
  only_for(!o.is_image() && o.voxels == 0, "--smoothing", "a label image, or to --voxels");
  only_for(o.voxels > 0, "--feature-angle", "surfaces without --voxels");
  for (const char* option : {"--diagnose", "--void", "--repair", "--repaired", "--largest-hole",
                             "--wrap-alpha", "--wrap-offset", "--feature-angle", "--voxels"})
    only_for(o.is_image(), option, "surfaces, not to a label image");
  const auto images = std::count_if(o.surfaces.begin(), o.surfaces.end(), is_label_image);
  if (images > 0 && o.surfaces.size() > 1)
    faults.push_back({"SURFACE", "a label image is meshed alone: it holds all the labels"});
}

// Checks the names of the outputs: their folders exist, none is itself a folder, and no two are the same.
void check_outputs(const Options& o, std::vector<Fault>& faults) {
  const std::vector<std::string> names = o.outputs();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::filesystem::path file(names[i]);
    if (names[i].empty()) continue;
    if (file.has_parent_path() && !std::filesystem::is_directory(file.parent_path()))
      faults.push_back({names[i], "there is no folder " + file.parent_path().string()});
    if (std::filesystem::is_directory(file)) faults.push_back({names[i], "is a folder, expected a file"});
    for (std::size_t j = 0; j < i; ++j) {
      if (file.lexically_normal() == std::filesystem::path(names[j]).lexically_normal())
        faults.push_back({names[i], "is the name of two outputs"});
    }
  }
}

void check(const CLI::App& app, const Options& o) {
  std::vector<Fault> faults;
  check_image(app, o, faults);
  for (const char* option : {"--diagnose", "--repaired"}) {
    if (o.surfaces.size() > 1 && app.count(option) > 0)
      faults.push_back({option, "looks at one surface at a time"});
  }
  for (const char* option : {"--diagnose", "--repaired"})
    if (!o.voids.empty() && app.count(option) > 0)
      faults.push_back({"--void", std::string("not with ") + option});
  for (const char* option : {"--diagnose", "--output", "--repaired"})
    if (o.measure && app.count(option) > 0)
      faults.push_back({"--measure", std::string("not with ") + option});
  if (!o.diagnose && !o.measure && o.output.empty() && o.repaired.empty())
    faults.push_back({"--output", "missing: give -o MESH.vtu (or --diagnose, or --repaired SURFACE.ply)"});
  if (!o.output.empty() && !can_write_mesh(o.output)) {
    faults.push_back(
        {"--output", o.output + ": expected a name that ends in .vtu, .vtk, .msh, .msh2, .mesh or .node"});
  }
  if (!o.marked.empty() && !o.diagnose) faults.push_back({"--marked", "belongs to --diagnose"});
  if (!o.picture.empty() && (o.diagnose || o.output.empty()))
    faults.push_back({"--picture", "shows a mesh: give -o MESH.vtu, and not --diagnose"});
  if (!o.repaired.empty() && o.diagnose) faults.push_back({"--repaired", "not with --diagnose"});
  expect_ending("--repaired", o.repaired, {".obj", ".off", ".ply", ".stl", ".vtp"}, faults);
  expect_ending("--marked", o.marked, {".vtp", ".vtu", ".ply"}, faults);
  expect_ending("--picture", o.picture, {".png"}, faults);
  check_outputs(o, faults);
  const auto positive = [&](const char* name, double value) {
    if (app.count(name) > 0 && !(std::isfinite(value) && value > 0)) {
      faults.push_back({name, "must be a positive number"});
    }
  };
  positive("--edge", o.mesh.edge);
  positive("--scale", o.scale);
  positive("--voxels", o.voxels);
  positive("--largest-hole", o.repair.largest_hole);
  positive("--wrap-alpha", o.repair.wrap_alpha);
  positive("--wrap-offset", o.repair.wrap_offset);
  if (!faults.empty()) throw InputError(std::move(faults));
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
  for (const std::string& file : o.sizes) {
    const std::vector<SizeBall> balls = read_size_balls(file);
    o.mesh.balls.insert(o.mesh.balls.end(), balls.begin(), balls.end());
  }
}

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

// What is meshed, and how finely.
void declare_body(CLI::App& app, Options& o) {
  app.add_option(
         "SURFACE", o.surfaces,
         "closed surfaces: .stl, .obj, .ply, .off or .vtp; the first is label 0, the next 1 …, one within "
         "another, apart, or with the same triangles where they touch. Or one label image: .nrrd, .nhdr, "
         ".nii or .nii.gz")
      ->required();
  app.add_option(
         "--void", o.voids,
         "closed surface around a cavity, such as the inside of a bladder: nothing in it is meshed; can "
         "be repeated")
      ->allow_extra_args(false);
  app.add_option("-o,--output", o.output,
                 "mesh to write: .vtu, .vtk, .msh (4.1), .msh2 (2.2), .mesh or .node");
  app.add_option("--repaired", o.repaired,
                 "file for the surface after its repair: .obj, .off, .ply, .stl or .vtp; without -o no mesh "
                 "is made");
  app.add_flag("--diagnose", o.diagnose, "only say what is wrong with the surface");
  app.add_flag("--measure", o.measure,
               "only print how large the body is (JSON): its box, the factor to metres by its size, and the "
               "volume and area of its parts, in the coordinates of the file");
  app.add_option("--marked", o.marked,
                 "file for the surface with its faults as data of the triangles: .vtp, .vtu or .ply");
  app.add_option("--edge", o.mesh.edge, "edge of the tetrahedra [m]; default: diagonal / 25");
  app.add_option("--label-edge", o.label_edges, "LABEL=EDGE: another edge in one label [m]; can be repeated");
  app.add_option("--ball", o.balls, "X,Y,Z,RADIUS,EDGE: shorter edges in a ball [m]; can be repeated");
  app.add_option("--sizes", o.sizes,
                 "mesh (.vtu) whose point array `edge` asks for shorter edges [m]; can be repeated");
  app.add_option("--growth", o.mesh.growth, "of the edge per distance, where it changes")
      ->capture_default_str();
  app.add_flag("--keep-thin", o.mesh.keep_thin,
               "shorter edges along thin parts that the mesh would lose; always without --edge");
  app.add_flag("--accept-loss", o.mesh.accepts_loss,
               "be content with a mesh, or with voxels, that lose more than a quarter of a part's volume");
  CLI::Option* scale =
      app.add_option("--scale", o.scale, "factor on the coordinates of the file, 0.001 for millimetres")
          ->capture_default_str();
  app.add_flag("--find-units", o.find_units, "take a body of more than 2 m to be in millimetres")
      ->excludes(scale);
  CLI::Option* voxels =
      app.add_option("--voxels", o.voxels,
                     "edge of voxels that the surfaces are turned into first [m]: they may share walls and "
                     "overlap, the later one wins");
  app.add_flag(
         "--find-voxels", o.find_voxels,
         "where surfaces overlap or share other walls, turn them into voxels of a third of the edge, of "
         "which the smaller surface wins")
      ->excludes(voxels);
  app.add_option("--smoothing", o.mesh.smoothing,
                 "of the steps between a label image's voxels [voxels], 0: none")
      ->capture_default_str();
}

// How it is repaired and meshed, and what is told of it.
void declare_work(CLI::App& app, Options& o) {
  static const std::map<std::string, Mesher> meshers{{"cgal", Mesher::cgal}, {"tetgen", Mesher::tetgen}};
  static const std::map<std::string, Repair> levels{{"none", Repair::none},
                                                    {"basic", Repair::basic},
                                                    {"auto", Repair::wrap_if_needed},
                                                    {"wrap", Repair::wrap}};
  add_choice(app, "--mesher", o.mesh.mesher, meshers, "cgal (default) or tetgen (keeps creases)");
  add_choice(app, "--repair", o.repair.level, levels,
             "none, basic (default), auto (basic, and if that fails wrap) or wrap (last resort)");
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
  app.add_option(
      "--picture", o.picture,
      "file for a picture of boundary, cut-open mesh and dihedral angles: .png (needs lobe-picture)");
  app.add_option("--report", o.report, "file for the report (JSON)");
  app.add_flag("--json", o.json, "the report alone on standard output");
  app.add_flag("--quiet", o.quiet, "no progress on standard error");
}

}  // namespace

void declare_options(CLI::App& app, Options& options) {
  declare_body(app, options);
  declare_work(app, options);
}

void check_options(const CLI::App& app, Options& options) {
  check(app, options);
  read_sizing(options);
  options.has_scale = app.count("--scale") > 0;
  options.mesh.cavities = options.voids.size();
  options.surfaces.insert(options.surfaces.end(), options.voids.begin(), options.voids.end());
}

}  // namespace lobe::meshing
