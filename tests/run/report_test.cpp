// report.json: its numbers must agree with each other and with the frames.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "lobe/run/solve.h"
#include "lobe/scene/frames.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

double number(const Json& report, const char* pointer) {
  return report.at(Json::json_pointer(pointer)).get<double>();
}

Index sum_of(const Json& counts) {
  Index sum = 0;
  for (const Json& count : counts) sum += count.get<Index>();
  return sum;
}

Index sum_of_cuts(const Json& report) {
  Index sum = 0;
  for (const Json& cut : report["cuts"]) sum += cut["tetrahedra"].get<Index>();
  return sum;
}

// tetrahedra removed = sum of the cuts = those at the start − those at the end, of regions and series alike
void check_counts(const Json& report) {
  const Index removed = report["tetrahedra_removed"], first = report["series"].front()["tetrahedra"],
              last = report["series"].back()["tetrahedra"];
  CHECK(removed > 0);
  CHECK(removed == sum_of_cuts(report));
  CHECK(removed == first - last);
  CHECK(first == report["mesh"]["tetrahedra"]);
  CHECK(first == sum_of(report["regions"]));
  CHECK(last == sum_of(report["regions_at_end"]));
}

void check_series(const Json& report, std::size_t entries) {
  const Json& series = report["series"];
  REQUIRE(series.size() == entries);
  const double simulated = number(report, "/simulated_s");
  for (std::size_t i = 0; i < entries; ++i) {
    CHECK(number(series[i], "/time") == near(simulated * double(i) / double(entries - 1), 1e-12, simulated));
    CHECK(number(series[i], "/volume") > 0);
    double sum = 0, largest = 1e-12;  // [J]: at the start all are 0
    for (const char* part : {"kinetic", "elastic_linear", "elastic_nonlinear", "loads", "applied"}) {
      const Json& energy = series[i]["energy"][part];
      REQUIRE(energy.is_number());
      sum += energy.get<double>();
      largest = std::max(largest, std::abs(energy.get<double>()));
    }
    CHECK(number(series[i], "/energy/total") == near(sum, 1e-12, largest));
  }
}

}  // namespace

TEST_CASE("the report's numbers agree with each other and with the mesh") {
  const Folder folder;
  const RunResult result = play(write_scene_files(folder), folder.path / "out");
  const Json report = report_in(folder.path / "out");
  const TetMesh mesh = beam_mesh();
  CHECK(report["ok"] == true);
  CHECK(report["mesh"] == Json{{"vertices", mesh.vertex_count()}, {"tetrahedra", mesh.tet_count()}});
  CHECK(
      report["regions"] ==
      Json{{"tensor-mass", 72}, {"precomputed", 0}, {"nonlinear", 120}, {"reduced", 0}, {"corotational", 0}});
  CHECK(report["simulated_s"].get<double>() == near(0.3, 1e-12));
  CHECK(report["frames"] == 4);
  CHECK(report["threads"] == 1);
  CHECK(report["precision"] == "single");
  CHECK(report["warnings"] == Json(result.warnings));
  check_counts(report);
  check_series(report, 16);
  const Json& grasp = report["series"][5]["tools"][0];  // while it pulls up
  CHECK(grasp["name"] == "grasp");
  CHECK(grasp["position"].size() == 3);
  CHECK(grasp["force"][2].get<double>() > 0);
  CHECK(number(report, "/series/0/volume") == near(total_volume(mesh), 1e-12));
  CHECK(report["series"].back()["tetrahedra"] ==
        read_mesh(folder.path / "out" / frame_name(3)).mesh.tet_count());
}

TEST_CASE("steps and times of the report fit together") {
  const Folder folder;
  const RunResult result = play(write_scene_files(folder), folder.path / "out");
  const Json report = report_in(folder.path / "out");
  const double smallest = number(report, "/time_step_s/smallest"),
               largest = number(report, "/time_step_s/largest");
  CHECK(smallest > 0);
  CHECK(smallest <= largest);
  CHECK(number(report, "/time_step_s/limit_at_rest") > 0);
  CHECK(number(report, "/steps") >= 0.3 / largest - 1e-6);
  CHECK(number(report, "/steps") <= 0.3 / smallest + 1e-6);
  CHECK(number(report, "/smallest_volume_ratio") > 0);
  CHECK(number(report, "/smallest_volume_ratio") <= 1);
  double phases = 0;
  for (const Json& phase : report["timing"]["phases_s"]) phases += phase.get<double>();
  CHECK(phases == near(number(report, "/timing/simulation_s"), 1e-6));
  CHECK(report["timing"]["condensing_s"].size() == 3);
  CHECK(number(report, "/timing/condensing_s/factor") == 0);  // it has no such region
  CHECK(number(report, "/timing/slowest_frame_s") <= number(report, "/timing/simulation_s"));
  const std::string steps = "in " + std::to_string(report["steps"].get<int>()) + " steps";
  CHECK(result.summary.find(steps) != std::string::npos);
}

TEST_CASE("selective masses take the place of corrected regions, and the report tells their degrees") {
  const Folder folder;
  Json json = small_scene();
  json["time"]["selective_mass"] = 5;
  json["regions"] = {{"auto", {{"tolerance", 0.05}, {"correct", true}}}};
  const Scene scene = read_scene(write_scene_files(folder, json));
  const Resolved resolved = resolve(scene, beam_mesh());
  REQUIRE(resolved.warnings.size() == 1);
  CHECK(resolved.warnings[0] ==
        "/regions/auto: nothing is linear: time/selective_mass takes its place, and is corrected");
  CHECK(run_scene(scene, resolved, {folder.path / "out", 1, {}, make_ldlt, false, {}}).ok);
  const Json report = report_in(folder.path / "out");
  CHECK(report["regions"]["nonlinear"] == beam_mesh().tet_count());
  int frames = 0;
  for (const Json& count : report["selective_mass"]["frames_by_degree"]) frames += count.get<int>();
  CHECK(frames == 15);
  CHECK(report["selective_mass"]["frames_by_degree"]["1"].get<int>() > 0);
  CHECK(report["selective_mass"]["series"].size() == 16);
  CHECK_FALSE(report.contains("linearity"));
}

TEST_CASE("the error of reduced regions is estimated, reported and warned of") {
  const Folder folder;
  Json json = small_scene();
  json["regions"] = {{{"model", "reduced"}, {"cell", 0.018}}};
  json["tools"] = Json::array();
  json["time"]["duration"] = 1;
  json["gravity"] = {0, 0, -5};
  const RunResult result = play(write_scene_files(folder, json), folder.path / "out");
  REQUIRE(result.ok);
  const Json seen = report_in(folder.path / "out")["reduced"];
  CHECK(seen["series"].size() == 51);
  CHECK(seen["series"][0]["error"] == 0);
  CHECK(seen["worst_error"].get<double>() > 0.02);
  CHECK(seen["worst_place"][0].get<double>() > 0.04);
  CHECK(seen["frames_exceeded"].get<int>() > 0);
  REQUIRE(result.warnings.size() == 1);
  CHECK(result.warnings[0].starts_with("the error of reduced regions was estimated at up to "));
  CHECK(seen["vertices_to_full"] == 0);
  CHECK(read_mesh(folder.path / "out/frame_0010.vtu").cell_data.at("embedded").maxCoeff() == 1);
  json["regions"][0]["tolerance"] = 0.02;
  REQUIRE(play(write_scene_files(folder, json), folder.path / "corrected").ok);
  const Json corrected = report_in(folder.path / "corrected")["reduced"];
  CHECK(corrected["vertices_to_full"].get<int>() > 0);
  CHECK(corrected["worst_error"].get<double>() < seen["worst_error"].get<double>());
  REQUIRE(corrected["transitions"].size() > 1);
  for (const Json& of : corrected["transitions"]) {
    CHECK(of["count"].get<int>() > 0);
    const double total = of["total"].get<double>();
    const double sum = of["kinetic"].get<double>() + of["elastic"].get<double>() + of["loads"].get<double>();
    CHECK(std::abs(total - sum) <= 1e-12 * std::abs(total));
  }
  CHECK(corrected["transitions"].back()["elastic"] != 0);
  play(write_scene_files(folder), folder.path / "other");
  CHECK_FALSE(report_in(folder.path / "other").contains("reduced"));
  CHECK_FALSE(read_mesh(folder.path / "other/frame_0000.vtu").cell_data.contains("embedded"));
}

TEST_CASE("the series tells the energy of a probe that presses") {
  const Folder folder;
  Json scene = small_scene();
  scene["tools"] = Json::array({{{"type", "probe"},
                                 {"shape", {{"sphere", {{"radius", 0.005}}}}},
                                 {"path", {{0, 0.07, 0.01, 0.03}, {0.2, 0.07, 0.01, 0.02}}}}});
  play(write_scene_files(folder, scene), folder.path / "out");
  const Json report = report_in(folder.path / "out");
  check_series(report, 16);
  const Json& series = report["series"];
  CHECK(number(series.front(), "/energy/applied") == 0);  // it has not come yet
  CHECK(number(series.back(), "/energy/applied") > 0);
}

TEST_CASE("the report tells what was skipped") {
  const Folder folder;
  Json scene = small_scene();
  scene["tools"] = Json::array();
  scene["time"]["duration"] = 2;
  play(write_scene_files(folder, scene), folder.path / "awake");
  scene["time"]["sleep"] = 1e-5;
  play(write_scene_files(folder, scene), folder.path / "asleep");
  const Json awake = report_in(folder.path / "awake"), asleep = report_in(folder.path / "asleep");
  CHECK(awake["skipped"]["states_not_written"] == 101 - awake["frames"].get<int>());
  CHECK(awake["skipped"]["terms"] == Json{"guard_below", "nodal_pressure", "load_ramp", "sleep"});
  CHECK(asleep["skipped"]["terms"] == Json{"guard_below", "nodal_pressure", "load_ramp"});
  CHECK(number(awake, "/skipped/patches/share_asleep") == 0);
  const double evaluated = number(asleep, "/skipped/patches/evaluated"),
               skipped = number(asleep, "/skipped/patches/asleep");
  CHECK(skipped > 0);
  CHECK(evaluated + skipped <= number(awake, "/skipped/patches/evaluated"));
  CHECK(number(asleep, "/skipped/patches/share_asleep") == near(skipped / (evaluated + skipped), 1e-12));
}

TEST_CASE("the report tells at which levels tetrahedra stepped") {
  const Folder folder;
  Json scene = small_scene();
  scene["tools"] = Json::array();
  scene["time"]["duration"] = 0.2;
  scene["time"]["own_steps"] = true;
  play(write_scene_files(folder, scene), folder.path / "together");
  const Json together = report_in(folder.path / "together")["own_steps"];
  CHECK(together["frames"] == 0);
  CHECK(together["tetrahedra"] == Json{{{"times", 1}, {"share", 1}}});
  CHECK(number(together, "/share_evaluated") == 1);
  scene["materials"].insert(scene["materials"].begin(), Json::parse(R"({"lame_lambda": 8e6, "lame_mu": 2e6,
    "density": 1000, "where": {"box": {"min": [0.07, -1, -1], "max": [1, 1, 1]}}})"));
  play(write_scene_files(folder, scene), folder.path / "apart");
  const Json report = report_in(folder.path / "apart"), apart = report["own_steps"];
  CHECK(apart["frames"] == 10);
  double share = 0;
  for (const Json& level : apart["tetrahedra"]) share += number(level, "/share");
  CHECK(share == near(1, 1e-12));
  CHECK(apart["tetrahedra"].size() > 1);
  CHECK(number(apart, "/share_evaluated") < 0.9);
  CHECK(report["skipped"]["patches"]["asleep"] == 0);
}

TEST_CASE("loose pieces that vanish count as removed") {
  const Folder folder;
  Json scene = small_scene();
  scene["tools"].erase(0);
  scene["tools"][0]["radius"] = 0.02;
  scene["loose_pieces"] = "vanish";
  play(write_scene_files(folder, scene), folder.path / "out");
  const Json report = report_in(folder.path / "out");
  check_counts(report);
  CHECK(report["conditions"][0]["condition"] == "pieces");
  CHECK(report["series"].back()["tetrahedra"] < 120);  // nothing beyond the cut is left
}

TEST_CASE("a run that ends early says why, and its frames are finite") {
  const Folder folder;
  const RunResult result = play(write_scene_files(folder, torn_scene()), folder.path / "out");
  const Json report = report_in(folder.path / "out");
  CHECK_FALSE(result.ok);
  CHECK(report["ok"] == false);
  CHECK(number(report, "/simulated_s") == near(0.1, 1e-12));
  CHECK(report["conditions"].back()["condition"] == "diverged");
  REQUIRE(!result.warnings.empty());
  CHECK(result.warnings.back().find("volume_penalty") != std::string::npos);  // the remedy
  CHECK(report["warnings"].back() == result.warnings.back());
  check_counts(report);
  const std::size_t frames = report["frames"];
  CHECK(frames == 2);  // one per time, though the second was written again when the run ended
  for (std::size_t i = 0; i < frames; ++i) {
    const MeshFile frame = read_mesh(folder.path / "out" / frame_name(i));
    for (const auto* arrays : {&frame.point_data, &frame.cell_data})
      for (const auto& [name, values] : *arrays) CHECK_MESSAGE(values.allFinite(), name);
  }
  for (const Json& entry : report["series"]) CHECK(entry["energy"]["total"].is_number());
}

TEST_CASE("the report tells what a scalpel has cut, as a world does that plays the same scene") {
  const Folder folder;
  Json json = small_scene();
  json["tools"] = {
      {{"type", "scalpel"},
       {"path",
        {{0.02, 0.053, -0.01, 0.03, 0.053, 0.03, 0.03}, {0.2, 0.056, -0.01, -0.02, 0.056, 0.03, -0.02}}}}};
  const std::filesystem::path file = write_scene_files(folder, json);
  REQUIRE(play(file, folder.path / "out").ok);
  const Json report = report_in(folder.path / "out");

  const Scene scene = read_scene(file);
  World<float> world(resolve(scene, beam_mesh()).setup);
  const Frames frames = frames_of(scene.time);
  double area = 0;
  Index copied = 0;
  Report last;
  for (int i = 0; i < frames.count; ++i) {
    last = world.advance(frames.length);
    area += last.cut_area;
    copied += last.tets_copied;
  }
  double mass = 0, weight = 0;
  const Topology& topology = world.elements().topology;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    mass += world.body().inertia.mass()[std::size_t(v)];
    weight += world.body().inertia.weighs(v);
  }
  CHECK(weight == near(1000 * 0.08 * 0.02 * 0.02, 1e-6));
  CHECK(area > 0.9 * 0.02 * 0.02);
  CHECK(copied == topology.tet_copy_count());
  CHECK(copied > 20);
  CHECK(last.mass_added > 0);
  CHECK(last.mass_added == near(mass - weight, 1e-9, mass));
  CHECK(report["scalpel"] ==
        Json{{"cut_area_m2", area}, {"tetrahedra_copied", copied}, {"mass_added_kg", last.mass_added}});
  CHECK(report["series"].back()["tetrahedra"] == beam_mesh().tet_count() + copied);
  CHECK(report["tetrahedra_removed"] == 0);

  play(write_scene_files(folder), folder.path / "other");
  CHECK_FALSE(report_in(folder.path / "other").contains("scalpel"));
}

namespace {

// The beam between walls without friction, pressed together by a tenth of its length: one strain everywhere.
Json pressed_beam() {
  Json scene = small_scene();
  const auto wall = [](const Json& displacement, int axis, double at) {
    Json point{0, 0, 0}, normal{0, 0, 0};
    point[std::size_t(axis)] = at;
    normal[std::size_t(axis)] = 1;
    return Json{{"displacement", displacement},
                {"where", {{"plane", {{"point", point}, {"normal", normal}, {"within", 1e-9}}}}}};
  };
  scene["boundary"] = {wall({0, nullptr, nullptr}, 0, 0), wall({-0.008, nullptr, nullptr}, 0, 0.08)};
  for (const double at : {0.0, 0.02}) {
    scene["boundary"].push_back(wall({nullptr, 0, nullptr}, 1, at));
    scene["boundary"].push_back(wall({nullptr, nullptr, 0}, 2, at));
  }
  for (const char* key : {"regions", "gravity", "tools", "volume_penalty"}) scene.erase(key);
  scene["time"]["precision"] = "double";
  scene["time"]["duration"] = 1;
  scene["time"]["damping"] = 60;
  return scene;
}

void check_pressed(const Json& reactions) {
  REQUIRE(reactions.size() == 6);
  const double strain = (0.9 * 0.9 - 1) / 2, along = 0.02 * 0.02 * 6e4 * 0.9 * strain,
               across = 0.02 * 0.08 * 4e4 * strain;  // A (λ + 2μ) F E, and that of λ E on the rest area
  const Vec3d expected[] = {{-along, 0, 0},  {along, 0, 0},  {0, -across, 0},
                            {0, 0, -across}, {0, across, 0}, {0, 0, across}};
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(reactions[i]["entry"] == "/boundary/" + std::to_string(i));
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(reactions[i]["force"][k].get<double>() ==
            near(expected[i][Eigen::Index(k)], 1e-6, std::abs(along)));
  }
}

// The rows of the point array reaction sum up to nothing, its first row at one end to the force there.
void check_array(const std::filesystem::path& file, double force) {
  const MeshFile read = read_mesh(file);
  REQUIRE(read.point_data.contains("reaction"));
  const Eigen::MatrixXd& reaction = read.point_data.at("reaction");
  REQUIRE(reaction.cols() == read.mesh.vertex_count());
  double at_end = 0;
  for (Index v = 0; v < read.mesh.vertex_count(); ++v)
    if (read.mesh.points(0, v) == 0) at_end += reaction(0, v);
  CHECK(at_end == near(force, 1e-6));
  CHECK(reaction.rowwise().sum().cwiseAbs().maxCoeff() < 1e-6 * std::abs(force));
}

}  // namespace

TEST_CASE("reactions of each entry of the boundary are the exact ones, in a solution and in a run") {
  const Folder folder;
  const std::filesystem::path file = write_scene_files(folder, pressed_beam());
  const Scene scene = read_scene(file);
  solve_scene(scene, resolve(scene, read_mesh(mesh_path(scene)).mesh),
              {folder.path / "solved", 1, {}, make_ldlt, false, {}});
  play(file, folder.path / "played");
  const double force = 0.02 * 0.02 * 6e4 * 0.9 * (1 - 0.9 * 0.9) / 2;
  check_pressed(report_in(folder.path / "solved")["reactions"]);
  check_array(folder.path / "solved" / "solution.vtu", force);
  const Json report = report_in(folder.path / "played");
  CHECK(report["series"].front()["reactions"][1]["force"][0].get<double>() == 0);
  check_pressed(report["series"].back()["reactions"]);
  check_array(folder.path / "played" / frame_name(report["frames"].get<std::size_t>() - 1), force);
}
