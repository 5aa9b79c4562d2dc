#include "commands.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "console.h"
#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/io/surface_io.h"
#include "lobe/linearity/total_error.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/topology.h"
#include "lobe/run/recording.h"
#include "lobe/run/run.h"
#include "lobe/run/solve.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/prolongated.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/unit_checks.h"
#include "lobe/sim/rest_time_step.h"
#include "lobe/text.h"
#include "pictures.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;

struct Loaded {
  Scene scene;
  Resolved resolved;
};

// Loads a scene. Automatic regions are chosen by static solutions of the gestures.
Loaded load(const SceneOptions& options, bool choose_regions = true) {
  Scene scene = read_scene(options.scene);
  if (!options.mesh.empty()) replace_mesh(options.mesh, scene);
  MeshFile mesh = read_scene_mesh(scene);
  bind_groups(mesh, scene);
  std::vector<std::string> warnings = mesh.warnings();
  ProgressBar bar("choosing regions");
  Resolved resolved =
      resolve(scene, std::move(mesh.mesh), {choose_regions, [&](double fraction) { bar.show(fraction); }});
  resolved.warnings.insert(resolved.warnings.begin(), warnings.begin(), warnings.end());
  return {std::move(scene), std::move(resolved)};
}

void print_proposal(const Proposal& proposal) {
  std::printf("linear: %.3g %% of the volume; step %.2f times as fast as all non-linear (predicted %.2f)\n",
              100 * proposal.linear_share, proposal.measured_speedup, proposal.predicted_speedup);
  for (const GestureOutcome& gesture : proposal.gestures)
    std::printf("  %-24s error %.2f %% (predicted %.2f %%)\n", gesture.name.c_str(), 100 * gesture.measured,
                100 * gesture.predicted);
  std::fflush(stdout);
}

Json share_json(const ErrorShare& share, bool has_force) {
  Json entry{{"relative_l2", share.l2}, {"largest_displacement_excess", share.largest}};
  if (has_force) entry["force_excess"] = share.force;
  return entry;
}

Json total_error_json(const std::vector<TotalError>& errors) {
  Json list = Json::array();
  for (const TotalError& error : errors) {
    Json& entry = list.emplace_back(Json{{"gesture", error.name}});
    if (!error.trouble.empty()) {
      entry["trouble"] = error.trouble;
      continue;
    }
    const bool has_force = error.force > 0;
    entry["largest_displacement_m"] = error.largest;
    if (has_force) entry["force_N"] = error.force;
    entry["element"] = share_json(error.element, has_force);
    if (error.held) entry["held"] = share_json(*error.held, has_force);
    if (error.total) entry["total"] = share_json(*error.total, has_force);
    if (!error.held_trouble.empty()) entry["held_trouble"] = error.held_trouble;
  }
  return list;
}

Json surfaces_json(const std::vector<SurfaceGroup>& surfaces) {
  Json list = Json::array();
  for (const SurfaceGroup& group : surfaces)
    list.push_back({{"number", group.number}, {"name", group.name}, {"triangles", group.triangles.size()}});
  return list;
}

Json label_names_json(const std::map<int, std::string>& names) {
  Json object = Json::object();
  for (const auto& [label, name] : names) object[std::to_string(label)] = name;
  return object;
}

Json info_json(const MeshFile& file, const InfoOptions& options) {
  const TetMesh& mesh = file.mesh;
  const Quality q = mesh_quality(mesh);
  std::map<std::string, Index> labels;
  for (int label : mesh.labels) ++labels[std::to_string(label)];
  const auto array = [](const Vec3d& p) { return Json{p[0], p[1], p[2]}; };
  const Elastic elastic{options.lame_lambda, options.lame_mu, options.density};
  return {
      {"mesh", options.mesh.string()},
      {"vertices", mesh.vertex_count()},
      {"tetrahedra", mesh.tet_count()},
      {"labels", labels},
      {"label_names", label_names_json(file.label_names)},
      {"surfaces", surfaces_json(file.surfaces)},
      {"pieces", Topology(mesh).pieces().size()},
      {"reoriented", file.prepared.reoriented},
      {"unreferenced_vertices", file.prepared.unreferenced},
      {"ignored_cells", file.ignored_cells},
      {"bounding_box_m", {{"min", array(q.box_min)}, {"max", array(q.box_max)}}},
      {"volume_m3", q.volume},
      {"smallest_tetrahedron_m3", q.smallest_tet_volume},
      {"dihedral_deg",
       {{"smallest", q.min_dihedral},
        {"median_smallest", q.median_min_dihedral},
        {"largest", q.max_dihedral}}},
      {"dihedral_histogram_10_deg", q.dihedral_histogram},
      {"smallest_altitude_m", q.smallest_altitude},
      {"smallest_altitude_ratio", q.smallest_altitude_ratio},
      {"worst_tetrahedron", q.worst_tet},
      {"mean_edge_m", q.mean_edge},
      {"material", {{"lame_lambda", elastic.lambda}, {"lame_mu", elastic.mu}, {"density", elastic.density}}},
      {"stable_time_step_s", rest_time_step(mesh, elastic)}};
}

void print_info(const Json& j) {
  const auto number = [&](const char* pointer) { return j[Json::json_pointer(pointer)].get<double>(); };
  std::printf("%s\n", j["mesh"].get<std::string>().c_str());
  std::printf("vertices            %d\ntetrahedra          %d\n", j["vertices"].get<int>(),
              j["tetrahedra"].get<int>());
  for (const auto& [label, count] : j["labels"].items())
    std::printf("  label %-11s %d%s\n", label.c_str(), count.get<int>(),
                j["label_names"].contains(label) ? (" " + j["label_names"][label].dump()).c_str() : "");
  for (const Json& surface : j["surfaces"])
    std::printf("  surface %-9d %d triangles%s\n", surface["number"].get<int>(),
                surface["triangles"].get<int>(),
                surface["name"] == "" ? "" : (" " + surface["name"].dump()).c_str());
  std::printf("pieces              %d\n", j["pieces"].get<int>());
  std::printf("bounding box        [%g, %g, %g] … [%g, %g, %g] m\n", number("/bounding_box_m/min/0"),
              number("/bounding_box_m/min/1"), number("/bounding_box_m/min/2"),
              number("/bounding_box_m/max/0"), number("/bounding_box_m/max/1"),
              number("/bounding_box_m/max/2"));
  std::printf("volume              %.6g m³\n", number("/volume_m3"));
  std::printf("dihedral angles     %.2f … %.2f°, median of the smallest %.2f°\n",
              number("/dihedral_deg/smallest"), number("/dihedral_deg/largest"),
              number("/dihedral_deg/median_smallest"));
  std::printf("smallest altitude   %.4g m, worst ratio to the longest edge %.3f (tetrahedron %d)\n",
              number("/smallest_altitude_m"), number("/smallest_altitude_ratio"),
              j["worst_tetrahedron"].get<int>());
  std::printf("mean edge           %.4g m\n", number("/mean_edge_m"));
  std::printf("stable time step    %.4g s for λ = %g Pa, μ = %g Pa, ρ = %g kg/m³\n",
              number("/stable_time_step_s"), number("/material/lame_lambda"), number("/material/lame_mu"),
              number("/material/density"));
}

// Eigen takes minutes where the factor is large.
void hint_at_faster_solver(const Setup& setup) {
  constexpr Index many = 30'000;  // vertices
  if (setup.mesh.vertex_count() < many || linked_solver.name != std::string("eigen")) return;
  std::fprintf(stderr, "lobe: %d vertices: this may take minutes; --solver cholmod is faster\n",
               setup.mesh.vertex_count());
}

// Plays or solves a scene with a progress bar, draws what pictures it asks for, prints the result.
int produce(const SceneOptions& options, const char* what, decltype(&run_scene) function) {
  Loaded loaded = load(options);
  print_warnings(loaded.resolved.warnings);
  if (function == solve_scene) hint_at_faster_solver(loaded.resolved.setup);
  RunResult result;
  {
    std::optional<ProgressBar> condensing("condensing");
    ProgressBar bar(what);
    RunOptions run_options{
        options.output,    options.threads,
        options.record,    options.quadratic ? linked_solver.make_definite : linked_solver.make,
        options.quadratic, {}};
    run_options.condensing = [&](double fraction) { condensing->show(fraction); };
    run_options.progress = [&](double fraction) {
      condensing.reset();
      bar.show(fraction);
    };
    result = function(loaded.scene, loaded.resolved, run_options);
  }
  // If it ended early, the last warning says why.
  const auto known = std::ptrdiff_t(loaded.resolved.warnings.size());
  print_warnings({result.warnings.begin() + known, result.warnings.end() - (result.ok ? 0 : 1)});
  if (!result.ok) print_errors(result.warnings.back());
  if (!result.picture_request.empty() && !options.no_pictures) {
    const std::string trouble = render_pictures(result.picture_request);
    if (!trouble.empty()) print_warnings({trouble});
  }
  if (options.json)
    std::cout << std::ifstream(result.report).rdbuf();
  else
    std::cout << result.summary << "written to " << options.output.string() << '\n';
  return result.ok ? done : ended_early;
}

}  // namespace

int info(const InfoOptions& options) {
  const Elastic e{options.lame_lambda, options.lame_mu, options.density};
  if (!(e.mu > 0) || !(3 * e.lambda + 2 * e.mu > 0) || !(e.density > 0) || !std::isfinite(e.lambda) ||
      !std::isfinite(e.mu) || !std::isfinite(e.density))
    throw InputError("material", "needs finite mu > 0, 3 lambda + 2 mu > 0 and density > 0");
  const MeshFile file = read_mesh(options.mesh);
  print_warnings(file.warnings());
  if (const std::string doubt = doubt_of_size(box_diagonal(file.mesh)); !doubt.empty())
    print_warnings({doubt + ": lobe convert --scale, or \"mesh_scale\" in the scene"});
  const Json j = info_json(file, options);
  if (options.json)
    std::cout << j.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print_info(j);
  return done;
}

// What the scene makes of the refinement of its mesh, which has its scale already.
std::function<Setup(const RefinedMesh&)> on_refinement(Scene scene, const TetMesh& mesh) {
  scene.mesh_scale = 1;
  return [scene, &mesh](const RefinedMesh& refined) {
    return resolve(prolongated(scene, mesh, refined), refined.mesh, {false, {}}).setup;
  };
}

int check(const SceneOptions& options) {
  const Loaded loaded = load(options, false);
  if (!loaded.scene.skin.empty()) read_obj(skin_path(loaded.scene));  // as lobe view will
  std::vector<TotalError> errors;
  if (options.total_error) {
    ProgressBar bar("solving");
    errors = total_errors(loaded.resolved.setup,
                          {linked_solver.make_definite, [&](double fraction) { bar.show(fraction); },
                           on_refinement(loaded.scene, loaded.resolved.setup.mesh)});
  }
  if (options.json) {
    Json description = Json::parse(describe_json(loaded.scene, loaded.resolved));
    if (options.total_error) description["total_error"] = total_error_json(errors);
    std::cout << description.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    return done;
  }
  std::cout << describe(loaded.scene, loaded.resolved);
  if (options.total_error) std::cout << total_error_table(errors);
  return done;
}

int run(const SceneOptions& options) { return produce(options, "simulating", run_scene); }

int replay(const SceneOptions& options) {
  const Recording recording = read_recording(options.record);
  const Loaded loaded = load(options);
  const Setup setup = as_recorded(recording, loaded.resolved.setup);
  const auto play = [&](auto world) { return replay(recording, world); };
  const ReplayResult replayed = loaded.scene.in_double() ? play(World<double>(setup, options.threads))
                                                         : play(World<float>(setup, options.threads));
  if (!replayed.same) {
    print_errors(options.record.string() + ": command " + std::to_string(replayed.commands) + " of " +
                 std::to_string(recording.commands.size()) + ", up to " + rounded(replayed.time) +
                 " s, gives other bits than were recorded");
    return ended_early;
  }
  std::cout << replayed.commands << " commands up to " << rounded(replayed.time) << " s: the same bits on "
            << options.threads << " thread(s)\n";
  return done;
}

int solve(const SceneOptions& options) { return produce(options, "solving", solve_scene); }

int compare(const CompareOptions& options) {
  const Difference d = compare_fields(read_field(options.a), read_field(options.b));
  const Json j{{"relative_l2", d.l2},
               {"relative_h1", d.h1},
               {"max_m", d.max},
               {"relative_max", d.relative_max},
               {"worst_vertex", d.worst_vertex},
               {"volume_a_m3", d.volume_a},
               {"volume_b_m3", d.volume_b},
               {"rest_volume_a_m3", d.rest_volume_a},
               {"rest_volume_b_m3", d.rest_volume_b},
               {"weight", d.by_mass ? "mass" : "volume"},
               {"same_mesh", d.same_mesh},
               {"outside_fraction", d.outside_fraction},
               {"largest_gap_m", d.largest_gap}};
  if (options.json) {
    std::cout << j.dump(1) << '\n';
    return done;
  }
  std::printf(
      "relative L2 %.6g (by %s), H1 semi-norm %.6g, largest %.6g m (%.6g of the largest displacement) at "
      "vertex %d\nvolume %.8g and %.8g m³\n",
      d.l2, d.by_mass ? "mass" : "volume", d.h1, d.max, d.relative_max, d.worst_vertex, d.volume_a,
      d.volume_b);
  if (!d.same_mesh)
    std::printf("different meshes: %.4g %% of B lies outside A, by at most %.4g m\n",
                100 * d.outside_fraction, d.largest_gap);
  return done;
}

int regions(const SceneOptions& options) {
  if (options.output.extension() != ".vtu")
    throw InputError(options.output.string(), "the mesh is written as VTU; give a name that ends in .vtu");
  Loaded loaded = load(options);
  print_warnings(loaded.resolved.warnings);
  const Setup& setup = loaded.resolved.setup;
  DataArray region{"region", Eigen::MatrixXd(1, setup.mesh.tet_count()), DataArray::Type::int32};
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    region.values(0, t) = static_cast<int>(setup.region_of[t]);
  write_vtu(options.output, setup.mesh, {}, {region});
  if (loaded.resolved.proposal) print_proposal(*loaded.resolved.proposal);
  std::cout << "written to " << options.output.string() << '\n';
  if (options.picture.empty()) return done;
  const std::string trouble = draw_cells(options.output, "region", options.picture);
  if (!trouble.empty()) print_warnings({trouble});
  return done;
}

}  // namespace lobe::program
