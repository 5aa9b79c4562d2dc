// Run time against error: its parts, and `lobe bench accuracy` itself.
#include "benchmarks/accuracy.h"

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "bench_results.h"
#include "benchmarks/accuracy_error.h"
#include "benchmarks/accuracy_models.h"
#include "folder.h"
#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/prolongated.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/select.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::bench;
using namespace lobe::test;

namespace {

// A short beam whose free end is lifted through 30 degrees, so that its middle turns.
const char* turning = R"({
  "mesh": "beam.vtu",
  "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
  "volume_penalty": 1e5,
  "boundary": [{"fix": true, "where": {"box": {"min": [0, 0, 0], "max": [0, 1, 1]}}}],
  "tools": [{"type": "grasp", "where": {"box": {"min": [0.06, 0, 0], "max": [0.06, 1, 1]}},
             "path": [[0, 0, 0, 0], [0.2, -0.01, 0, 0.035]]}],
  "time": {"duration": 0.3, "frame": 0.02, "damping": 20}
})";

TetMesh beam(int n) { return box_mesh({0.06, 0.02, 0.02}, 3 * n, n, n); }

Case turning_case(std::vector<TetMesh> meshes) {
  return {"turning", parse_scene(turning), std::move(meshes)};
}

Setup turning_setup(int n = 2) { return resolve(parse_scene(turning), beam(n)).setup; }

const AccuracyRow& row_of(const Accuracy& accuracy, const std::string& model, const std::string& precision,
                          double safety, Index tets) {
  for (const AccuracyRow& row : accuracy.rows)
    if (row.model == model && row.precision == precision && row.safety == safety && row.tets == tets)
      return row;
  FAIL("no row of " << model);
  return accuracy.rows.front();
}

Mat3X<double> affine(const TetMesh& mesh, const Mat3<double>& F) {
  return affine_displacement(mesh.points, F);
}

const Mat3<double> stretch = (Mat3<double>() << 1.1, 0.05, 0, 0, 0.95, 0.02, 0, 0, 1.2).finished();

}  // namespace

TEST_CASE("every model of a gesture that turns a body has the error that it must have") {
  const Accuracy accuracy = measure_accuracy(turning_case({beam(1), beam(2)}), 1);
  CHECK(accuracy.warnings.empty());
  CHECK(accuracy.rows.size() == 2 * 11 * 2 * 2);  // meshes × models × precisions × steps
  for (const AccuracyRow& row : accuracy.rows) {
    INFO(row.model << ' ' << row.precision << ' ' << row.safety);
    // A frame in which tetrahedra become full may be run again.
    CHECK((row.status == "done" || (row.model == "reduced_corrected" && row.status == "done; sub-stepped")));
    CHECK(row.has_total);
    CHECK(row.wall_per_s > 0);
    CHECK(row.dt > 0);
    CHECK(row.error_total > row.total_reference_change);
  }
  for (const Index tets : {18, 144}) {
    const AccuracyRow& exact = row_of(accuracy, "svk_volume", "double", 0.45, tets);
    CHECK(exact.error_model < 1e-3);  // nothing but the time step differs from the reference
    CHECK(exact.error_model < row_of(accuracy, "svk_volume", "double", 0.9, tets).error_model);
    CHECK(exact.model_reference_change < exact.error_model);
    CHECK(row_of(accuracy, "svk_volume", "single", 0.45, tets).error_model < 1e-3);
    const double linear = row_of(accuracy, "tensor_mass", "double", 0.45, tets).error_model;
    CHECK(linear > 0.02);
    CHECK(row_of(accuracy, "svk", "double", 0.45, tets).error_model < linear);
    CHECK(row_of(accuracy, "hybrid_strain_50", "double", 0.45, tets).error_model > exact.error_model);
  }
  CHECK(row_of(accuracy, "svk_volume", "double", 0.9, 144).error_total <
        row_of(accuracy, "svk_volume", "double", 0.9, 18).error_total);
  CHECK(row_of(accuracy, "svk_volume", "double", 0.9, 18).dt >
        1.9 * row_of(accuracy, "svk_volume", "double", 0.45, 18).dt);
  CHECK(row_of(accuracy, "tensor_mass", "single", 0.9, 144).linear_fraction == 1);
  CHECK(row_of(accuracy, "hybrid_held_50", "single", 0.9, 144).linear_fraction == near(0.5, 1e-12));
}

TEST_CASE("all ways but those in double precision") {
  const Accuracy accuracy = measure_accuracy(turning_case({beam(1)}), 1, nullptr, false);
  CHECK(accuracy.rows.size() == 11 * 2);
  for (const AccuracyRow& row : accuracy.rows) CHECK(row.precision == "single");
}

TEST_CASE("a row is on the Pareto front unless another of its scene is as good and in one figure better") {
  const auto row = [](const char* scene, double wall, double error, bool to_the_end = true,
                      bool total = true) {
    AccuracyRow r;
    r.scene = scene;
    r.wall_per_s = wall;
    r.error_total = error;
    r.to_the_end = to_the_end;
    r.has_total = total;
    return r;
  };
  std::vector<AccuracyRow> rows{row("a", 1, 9),        row("a", 2, 4), row("a", 2, 5),
                                row("a", 3, 4),        row("a", 4, 1), row("a", 4, 1),
                                row("a", 0, 0, false), row("b", 9, 9), row("a", 0, 0, true, false)};
  mark_pareto(rows);
  const std::vector<bool> expected{true, true, false, false, true, true, false, true, false};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CAPTURE(i);
    CHECK(rows[i].pareto == expected[i]);
  }
}

TEST_CASE(
    "the table has the columns that docs/benchmarks/accuracy.md explains, and no number where there is "
    "none") {
  AccuracyRow good, diverged;
  good.model = diverged.model = "svk";
  good.status = "done";
  good.error_model = 0.25;
  diverged.to_the_end = false;
  diverged.wall_per_s = diverged.dt = diverged.error_model = 77;
  diverged.has_total = true;
  diverged.status = "diverged at 0.1 s";
  std::istringstream csv(accuracy_csv({good, diverged}));
  std::string line;
  REQUIRE(std::getline(csv, line));
  CHECK(line.starts_with(
      "model,precision,tets,dt_s,wall_s_per_s,error_model,error_total,scene,safety,pareto,"));
  const std::string docs = bytes_of(LOBE_DATA_DIR "/../docs/benchmarks/accuracy.md");
  for (const std::string& column : cells_of(line))
    CHECK_MESSAGE(docs.find('`' + column + '`') != docs.npos, column);
  const std::size_t columns = cells_of(line).size();
  REQUIRE(std::getline(csv, line));
  CHECK(cells_of(line).size() == columns);
  CHECK(cells_of(line)[5] == "0.25");
  CHECK(cells_of(line)[6] == "");  // no total
  REQUIRE(std::getline(csv, line));
  CHECK(cells_of(line).size() == columns);
  CHECK(line.find("77") == line.npos);
  CHECK(line.ends_with(",diverged at 0.1 s"));
  for (std::size_t empty : {3, 4, 5, 6}) CHECK(cells_of(line)[empty] == "");
}

TEST_CASE("a run that diverges says so; as a reference it is refused") {
  Setup torn = turning_setup();
  torn.grasps[0].path = {{0.1, {0, 0, 0}}, {0.11, {1000, 0, 0}}};
  const Schedule schedule{30, 10, 0.01};
  const Played played = play(torn, schedule, {Precision::single_precision, 0.9, 1});
  CHECK_FALSE(played.to_the_end);
  CHECK(played.status == "diverged at 0.1 s");
  CHECK(played.samples.size() == 3);
  CHECK_THROWS_AS(play_reference(torn, schedule, 0.9, 1), WrongResult);
}

TEST_CASE("all runs of a scene are sampled at the same times, the last at the end") {
  Time time;
  time.duration = 0.7;
  time.frame = 0.02;
  const Schedule schedule = schedule_of(time);
  CHECK(schedule.frames == 40);
  CHECK(schedule.duration() == near(0.7, 1e-15));
  time.frame = 5;
  CHECK(schedule_of(time).frames == 10);
  const Setup setup = turning_setup();
  const Samples samples = play_reference(setup, {20, 10, 0.01}, 0.9, 1);
  REQUIRE(samples.size() == 10);
  const Index grasped = setup.grasps[0].vertices.front();
  for (int i = 0; i < 10; ++i)  // the path goes from 0 to 0.035 m in 0.2 s
    CHECK(samples[std::size_t(i)](2, grasped) == near(0.0035 * (i + 1), 1e-12));
}

TEST_CASE("an error is the mass-weighted distance relative to the reference, on its mesh or on another") {
  Setup reference = turning_setup();
  const TetMesh& mesh = reference.mesh;
  const Samples expected{affine(mesh, stretch), 2 * affine(mesh, stretch)};
  const Samples close{1.1 * expected[0], 1.1 * expected[1]};
  CHECK(ErrorNorm(reference).relative(expected, expected) == 0);
  CHECK(ErrorNorm(reference).relative(close, expected) == near(0.1, 1e-12));
  const TetMesh other = box_mesh({0.06, 0.02, 0.02}, 4, 3, 1);
  const Samples interpolated{1.1 * affine(other, stretch), 2.2 * affine(other, stretch)};
  CHECK(ErrorNorm(reference, other).relative(interpolated, expected) == near(0.1, 1e-12));
  // Double the density of what moves along x: of two equal halves of the mass, only one errs.
  Mat3X<double> one = Mat3X<double>::Ones(3, mesh.vertex_count()), off = one;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) < 0.03 - 1e-9) off.col(v) *= 2;
  reference.materials.push_back(reference.materials[0]);
  reference.materials[1].density *= 3;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    reference.material_of[std::size_t(t)] = barycentre(mesh, t).x() < 0.03;
  const double light = ErrorNorm(turning_setup()).relative({off}, {one});
  const double heavy = ErrorNorm(reference).relative({off}, {one});
  CHECK(light * light == near(0.5 - 0.5 / 6, 1e-9));  // half a layer is shared with the other half
  CHECK(heavy > light);
  CHECK_THROWS_AS(ErrorNorm(reference).relative({0 * one}, {0 * one}), InputError);
  TetMesh away = other;
  away.points.row(1).array() += 0.1;
  CHECK_THROWS_AS(ErrorNorm(reference, away), InputError);
}

TEST_CASE(
    "a linear trial solution takes grasps at their last offset; an affine one strains every part alike") {
  Setup setup = turning_setup();
  setup.prescribed.clear();
  setup.grasps.clear();
  GraspSetup all;
  const Mat3X<double> u = affine(setup.mesh, stretch);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const bool surface = (setup.mesh.points.col(v).array() < 1e-9).any() ||
                         (setup.mesh.points.col(v).array() > Eigen::Array3d(0.06, 0.02, 0.02) - 1e-9).any();
    if (!surface) continue;
    GraspSetup grasp;
    grasp.vertices = {v};
    grasp.path = {{0, Vec3d::Zero()}, {1, u.col(v)}};
    setup.grasps.push_back(grasp);
  }
  const Mat3X<double> trial = linear_trial(setup);
  CHECK((trial - u).norm() < 1e-9 * u.norm());
  const Mat3<double> H = stretch - Mat3<double>::Identity();
  for (double norm : smoothed_norm(setup.mesh, trial, Measure::strain))
    CHECK(norm == near((H + H.transpose()).norm() / 2, 1e-8));
  for (double norm : smoothed_norm(setup.mesh, trial, Measure::gradient)) CHECK(norm == near(H.norm(), 1e-8));
}

TEST_CASE("the part with the least score becomes linear, up to a fraction of the volume") {
  Setup setup = turning_setup();
  std::vector<double> score;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) score.push_back(barycentre(setup.mesh, t).x());
  CHECK(make_linear(setup, score, 0.5) == near(0.5, 1e-12));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    CHECK((setup.region_of[std::size_t(t)] == RegionModel::tensor_mass) == (score[std::size_t(t)] < 0.03));
  CHECK(make_linear(setup, score, 1) == near(1, 1e-12));
  CHECK(make_linear(setup, score, 0) == 0);
}

TEST_CASE("what cannot be had is left out with a warning") {
  Setup loose = turning_setup();
  loose.prescribed.clear();
  loose.grasps.clear();
  loose.volume_penalty = 0;
  std::vector<std::string> warnings;
  const std::vector<Model> models = make_models(loose, warnings);
  REQUIRE(models.size() == 6);
  CHECK(models[0].name == "tensor_mass");
  CHECK(models[1].name == "svk");
  CHECK(models[3].name == "reduced");
  CHECK(models[4].name == "reduced_corrected");
  CHECK(models[4].is_corrected);
  CHECK(models[5].name == "selective_mass_corrected");
  CHECK(models[5].setup.selective_mass == 12);
  CHECK(warnings.size() == 2);
}

TEST_CASE("selections by number follow the refinement, and mean what the geometric ones mean") {
  const TetMesh mesh = beam(2);
  const RefinedMesh refined = refine(mesh);
  const auto face = [](double x) { return Selector{SelectBox{{x, 0, 0}, {x, 1, 1}}}; };
  Scene by_number = parse_scene(turning);
  CHECK_FALSE(selects_by_number(by_number));
  by_number.boundary[0].where = {SelectVertices{select_vertices(face(0), mesh)}};
  by_number.tools[0].as<GraspSetup>().where = {SelectAnyOf{{{SelectNearest{{1, 0.01, 0.01}, 9}}}}};
  by_number.materials[0].where = {SelectTetrahedra{{3, 100}}};
  by_number.materials.push_back({});
  CHECK(selects_by_number(by_number));
  const Scene fine = prolongated(by_number, mesh, refined);
  CHECK(select_vertices(fine.boundary[0].where, refined.mesh) == select_vertices(face(0), refined.mesh));
  CHECK(select_vertices(*fine.tools[0].where(), refined.mesh) == select_vertices(face(0.06), refined.mesh));
  std::vector<Index> children;
  for (Index t = 0; t < refined.mesh.tet_count(); ++t)
    if (refined.parent_of[std::size_t(t)] == 3 || refined.parent_of[std::size_t(t)] == 100)
      children.push_back(t);
  CHECK(select_tets(*fine.materials[0].where, refined.mesh) == children);
  Scene by_count = parse_scene(turning);
  by_count.tools[0].as<GraspSetup>().where = {SelectNearest{{1, 0.01, 0.01}, 4}};
  const Accuracy accuracy = measure_accuracy({"count", by_count, {beam(1), mesh}}, 1);
  REQUIRE(accuracy.warnings.size() == 1);
  CHECK(accuracy.warnings[0].find("largest mesh only") != std::string::npos);
  for (const AccuracyRow& row : accuracy.rows) CHECK(row.has_total == (row.tets == mesh.tet_count()));
}

TEST_CASE("the shipped scenes are there, on meshes of the sizes asked for and of their own") {
  const auto equal = [](const TetMesh& a, const TetMesh& b) {
    return a.points == b.points && a.tets.cols() == b.tets.cols() && a.tets == b.tets;
  };
  Options options;
  options.tets = {1500, 700};
  const std::vector<Case> cases = make_cases(options);
  REQUIRE(cases.size() == 3);
  for (const Case& one : cases) {
    CHECK(one.meshes.size() == 2);
    CHECK(one.meshes[0].tet_count() < one.meshes[1].tet_count());
    CHECK_FALSE(selects_by_number(one.scene));
    for (const TetMesh& mesh : one.meshes) CHECK(resolve(one.scene, mesh).warnings.empty());
    if (one.name != "liver") CHECK(one.meshes[1].tet_count() == near(1500, 0.7));
  }
  CHECK(equal(read_mesh(LOBE_DATA_DIR "/meshes/beam_1k.vtu").mesh, cases[0].meshes[1]));
  CHECK(equal(read_mesh(LOBE_DATA_DIR "/meshes/cylinder_1k.vtu").mesh, cases[1].meshes[0]));
}

TEST_CASE("lobe bench accuracy plays a user's own scene on its meshes and writes table and plot script") {
  const Folder folder;
  const auto lobe_bench = [&](const std::string& arguments) {
    const int status = std::system(("cd '" + folder.path.string() + "' && '" LOBE_BIN_DIR "/lobe' bench " +
                                    arguments + " >out.txt 2>err.txt")
                                       .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  std::string scene = turning;
  scene.replace(scene.find("\"tools\": ["), 10,
                R"("tools": [{"type": "cautery", "radius": 0.01, "path": [[0, 0, 0, 0], [1, 0, 0, 0]]}, )");
  folder.write("my scene.json", scene);
  write_vtu(folder.path / "beam.vtu", beam(1));
  write_vtu(folder.path / "finer.vtu", beam(2));
  const int status = lobe_bench("accuracy --scene 'my scene.json' --mesh finer.vtu -o results");
  const std::string errors = bytes_of(folder.path / "err.txt");
  REQUIRE_MESSAGE(status == 0, errors);
  CHECK(errors.find("my_scene: the tool cautery is left out") != errors.npos);
  std::istringstream csv(bytes_of(folder.path / "results" / "accuracy.csv"));
  std::set<std::string> sizes, scenes;
  std::string line;
  int rows = 0, front = 0;
  for (std::getline(csv, line); std::getline(csv, line); ++rows) {
    const auto cells = cells_of(line);
    sizes.insert(cells[2]);
    scenes.insert(cells[7]);
    front += cells[9] == "1";
    for (int number : {3, 4, 5, 6}) CHECK(std::stod(cells[std::size_t(number)]) >= 0);
  }
  CHECK(rows == 88);
  CHECK(front > 1);
  CHECK(sizes == std::set<std::string>{"18", "144"});
  CHECK(scenes == std::set<std::string>{"my_scene"});
  CHECK(std::filesystem::exists(folder.path / "results" / "accuracy.gp"));
  CHECK(std::filesystem::exists(folder.path / "results" / "machine.txt"));
  REQUIRE(lobe_bench("accuracy --scene 'my scene.json' --mesh finer.vtu --quick --single -o quick") == 0);
  const std::string quick = bytes_of(folder.path / "quick" / "accuracy.csv");
  CHECK(std::count(quick.begin(), quick.end(), '\n') == 1 + 22);
  // Against the same refined mesh, total errors are the same.
  REQUIRE(lobe_bench("accuracy --scene 'my scene.json' --refine finer.vtu -o refined") == 0);
  const auto coarse_rows = [&](const char* name) {
    std::vector<std::vector<std::string>> found;
    std::istringstream table(bytes_of(folder.path / name / "accuracy.csv"));
    std::string row;
    for (std::getline(table, row); std::getline(table, row);)
      if (const auto cells = cells_of(row); cells[2] == "18") found.push_back(cells);
    return found;
  };
  const auto all = coarse_rows("results"), refined = coarse_rows("refined");
  REQUIRE(refined.size() == 44);
  REQUIRE(all.size() == 44);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (int number : {5, 6}) CHECK(refined[i][std::size_t(number)] == all[i][std::size_t(number)]);
  std::istringstream quick_table(quick);
  std::getline(quick_table, line);
  std::getline(quick_table, line);
  CHECK(cells_of(line)[6] != refined[0][6]);  // whose own mesh is refined
  write_vtu(folder.path / "other.vtu", box_mesh({0.06, 0.02, 0.06}, 3, 1, 3));
  CHECK(lobe_bench("accuracy --scene 'my scene.json' --mesh other.vtu -o other") == 2);
  CHECK(bytes_of(folder.path / "err.txt").find("does not cover the same body") != errors.npos);
  CHECK(lobe_bench("accuracy --scene 'my scene.json' --tets 100 -o none") == 2);
  CHECK(lobe_bench("accuracy --mesh finer.vtu -o none") == 2);
  CHECK(lobe_bench("accuracy --refine finer.vtu -o none") == 2);
  CHECK(lobe_bench("accuracy --scene 'my scene.json' --refine missing.vtu -o none") == 2);
  CHECK(lobe_bench("kernels --refine finer.vtu -o none") == 2);
  CHECK(lobe_bench("accuracy --scene missing.json -o none") == 2);
  CHECK(lobe_bench("kernels --scene 'my scene.json' -o none") == 2);
  CHECK_FALSE(std::filesystem::exists(folder.path / "none"));
}
