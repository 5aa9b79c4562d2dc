// The command `lobe` as its callers use it: exit statuses, messages, files.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>

#include "lobe/mesh/quality.h"
#include "lobe_command.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;
namespace fs = std::filesystem;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

}  // namespace

TEST_CASE("lobe run writes its files and a summary, and ends with status 0") {
  const Folder folder;
  write_scene_files(folder);
  const Ended run = lobe_in(folder, "run scene.json -o out");
  CHECK_MESSAGE(run.status == 0, run.err);
  CHECK(run.err.empty());
  CHECK(run.out.starts_with("simulated 0.300 s in "));
  CHECK(run.out.ends_with("written to out\n"));
  CHECK(fs::exists(folder.path / "out" / "series.pvd"));
  CHECK(fs::exists(folder.path / "out" / frame_name(3)));
  CHECK(report_in(folder.path / "out")["ok"] == true);
}

TEST_CASE("lobe run --json prints the report alone; --threads changes no frame") {
  const Folder folder;
  write_scene_files(folder);
  const Ended one = lobe_in(folder, "run scene.json -o one --json");
  CHECK(one.status == 0);
  CHECK(one.out == bytes_of(folder.path / "one" / "report.json"));
  const Ended two = lobe_in(folder, "run scene.json -o two --json --threads 2");
  CHECK(Json::parse(two.out)["threads"] == 2);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(bytes_of(folder.path / "one" / frame_name(i)) == bytes_of(folder.path / "two" / frame_name(i)));
}

TEST_CASE("lobe replay plays what run --record wrote, on other threads, and finds what differs") {
  const Folder folder;
  write_scene_files(folder);
  REQUIRE(lobe_in(folder, "run scene.json -o out --record gesture").status == 0);
  const Ended same = lobe_in(folder, "replay scene.json gesture --threads 2");
  CHECK_MESSAGE(same.status == 0, same.err);
  CHECK(same.out == "15 commands up to 0.3 s: the same bits on 2 thread(s)\n");
  Json other = small_scene();
  other["gravity"] = {0, 0, -2};
  folder.write("other.json", other.dump());
  const Ended refused = lobe_in(folder, "replay other.json gesture");
  CHECK(refused.status == 2);
  CHECK(contains(refused.err, "is of another scene"));
  folder.write("cut", bytes_of(folder.path / "gesture").substr(0, 100));
  CHECK(contains(lobe_in(folder, "replay scene.json cut").err, "cut: is cut off"));
}

TEST_CASE("lobe run --mesh takes another mesh than the scene's") {
  const Folder folder;
  write_scene_files(folder);
  write_vtu(folder.path / "finer.vtu", box_mesh({0.08, 0.02, 0.02}, 16, 4, 4));
  const Ended run = lobe_in(folder, "run scene.json --mesh finer.vtu -o out --json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  CHECK(Json::parse(run.out)["mesh"]["tetrahedra"] == 6 * 16 * 4 * 4);
}

TEST_CASE("a run that ends early is status 1, an error that says why, and a report") {
  const Folder folder;
  write_scene_files(folder, torn_scene());
  const Ended run = lobe_in(folder, "run scene.json -o out");
  CHECK(run.status == 1);
  CHECK(contains(run.err, "s: no step down to "));
  CHECK(contains(run.err, "lobe: error: at "));
  CHECK(report_in(folder.path / "out")["ok"] == false);
}

TEST_CASE("bad input is status 2, one line per fault, and nothing is written") {
  const Folder folder;
  write_scene_files(folder);
  Json scene = small_scene();
  scene["materials"][0]["densty"] = 1000;
  scene["gravity"] = -9.81;
  folder.write("faulty.json", scene.dump());
  scene = small_scene();
  scene["boundary"][0]["where"] = {{"label", 77}};
  folder.write("nothing.json", scene.dump());
  folder.write("file", "");
  const auto refused = [&](const std::string& arguments, const std::string& message, long lines = 1) {
    CAPTURE(arguments);
    lobe_in(folder, "--version");  // so that messages.txt exists
    const std::size_t files = folder.file_count();
    const Ended ended = lobe_in(folder, arguments);
    CHECK(ended.status == 2);
    CHECK(ended.out.empty());
    CHECK(ended.err.starts_with("lobe: error: "));
    CHECK_MESSAGE(contains(ended.err, message), ended.err);
    CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == lines);
    CHECK(folder.file_count() == files);
  };
  for (const std::string command : {"check ", "run -o out ", "regions -o out.vtu "}) {
    refused(command + "faulty.json", "did you mean \"density\"?", 2);
    refused(command + "nothing.json", "/boundary/0/where: selects no vertex");
    refused(command + "missing.json", "missing.json");
    refused(command + "scene.json --mesh missing.vtu", "missing.vtu");
  }
  refused("run scene.json -o file", "cannot be made a directory");
  refused("regions scene.json -o out.vtk", "ends in .vtu");
  refused("info missing.vtu", "missing.vtu");
  refused("info scene.json", "scene.json");
  refused("info beam.vtu --mu 0", "needs finite mu > 0");
}

TEST_CASE("a wrong command line is status 2 and says what is wrong; help is status 0") {
  const Folder folder;
  write_scene_files(folder);
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    CAPTURE(arguments);
    const Ended ended = lobe_in(folder, arguments);
    CHECK(ended.status == 2);
    CHECK(ended.err.starts_with("lobe: error: "));
    CHECK_MESSAGE(contains(ended.err, message), ended.err);
    CHECK_FALSE(fs::exists(folder.path / "out"));
  };
  refused("", "subcommand");
  refused("rum scene.json -o out", "rum: is no command; did you mean \"run\"?");
  refused("fly", "fly: is no command (lobe --help lists them)");
  refused("run scene.json", "--output");
  refused("run -o out", "SCENE");
  refused("run scene.json -o out --threads 0", "--threads");
  refused("run scene.json -o out --threads two", "--threads");
  refused("run scene.json -o out --colour", "--colour");
  CHECK(lobe_in(folder, "--help").status == 0);
  CHECK(contains(lobe_in(folder, "run --help").out, "--no-pictures"));
}

TEST_CASE("the scene's mesh is not overwritten by its results") {
  const Folder folder;
  Json scene = small_scene();
  scene["mesh"] = "frame_0001.vtu";
  write_scene_files(folder, scene);
  write_vtu(folder.path / "frame_0001.vtu", beam_mesh());
  const std::string mesh = bytes_of(folder.path / "frame_0001.vtu");
  const Ended run = lobe_in(folder, "run scene.json -o .");
  CHECK(run.status == 2);
  CHECK(contains(run.err, "frame_0001.vtu: would be overwritten by the results; choose another directory"));
  CHECK(bytes_of(folder.path / "frame_0001.vtu") == mesh);
  CHECK_FALSE(fs::exists(folder.path / "report.json"));
}

TEST_CASE("lobe regions writes the mesh with the models that will be used") {
  const Folder folder;
  write_scene_files(folder);
  const Ended ended = lobe_in(folder, "regions scene.json -o tagged.vtu");
  CHECK(ended.status == 0);
  CHECK(ended.out == "written to tagged.vtu\n");
  const MeshFile tagged = read_mesh(folder.path / "tagged.vtu");
  const TetMesh input = beam_mesh();
  CHECK(tagged.mesh.points == input.points);
  CHECK(tagged.mesh.tets == input.tets);
  CHECK(tagged.mesh.labels == input.labels);
  for (Index t = 0; t < input.tet_count(); ++t)
    CHECK(tagged.cell_data.at("region")(0, t) == (barycentre(input, t).x() < 0.03 ? 0 : 2));
}

TEST_CASE("lobe regions and run choose regions where the scene leaves that to them") {
  const Folder folder;
  Json scene = small_scene();
  scene["regions"] = {{"auto", {{"tolerance", 0.3}, {"correct", true}}}};
  write_scene_files(folder, scene);
  const Ended chosen = lobe_in(folder, "regions scene.json -o tagged.vtu");
  CHECK(chosen.status == 0);
  CHECK(contains(chosen.out, "linear: "));
  CHECK(contains(chosen.out, "  grasp "));
  CHECK(read_mesh(folder.path / "tagged.vtu").cell_data.contains("region"));
  const Ended checked = lobe_in(folder, "check scene.json");
  CHECK(contains(checked.out, "automatic, for an error of 30 % in grasp"));
  const Ended ran = lobe_in(folder, "run scene.json -o out --no-pictures");
  CHECK(ran.status == 0);
  const Json report = report_in(folder.path / "out");
  CHECK(report["auto_regions"]["gestures"][0]["measured_error"].get<double>() <= 0.3);
  CHECK(report["linearity"]["series"].size() == 1 + 15);  // at the start, and after each frame
  CHECK(report["linearity"]["worst_error"].get<double>() >= 0);
}

TEST_CASE("lobe check says what will be run") {
  const Folder folder;
  write_scene_files(folder);
  const Ended ended = lobe_in(folder, "check scene.json --json");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  const Json check = Json::parse(ended.out);
  CHECK(check["mesh"]["tetrahedra"] == 192);
  CHECK(
      check["regions"] ==
      Json{{"tensor-mass", 72}, {"precomputed", 0}, {"nonlinear", 120}, {"reduced", 0}, {"corotational", 0}});
  CHECK(check["fixed_vertices"] == 9);
  CHECK(check["loads"]["mass_kg"].get<double>() == near(0.032, 1e-12));
  CHECK(check["tools"][0]["vertices"] == 9);
  CHECK(check["tools"][1]["radius_m"] == 0.004);
  CHECK(check["duration_s"] == 0.3);
  CHECK(check["warnings"].empty());
  lobe_in(folder, "run scene.json -o out");
  CHECK(check["vtu_frames"] == report_in(folder.path / "out")["frames"]);
  CHECK(contains(lobe_in(folder, "check scene.json").out, "192"));
}

TEST_CASE("lobe compare tells two results apart, also on different meshes, and refuses what is none") {
  const Folder folder;
  write_scene_files(folder);
  write_vtu(folder.path / "finer.vtu", box_mesh({0.08, 0.02, 0.02}, 16, 4, 4));
  lobe_in(folder, "solve scene.json -o coarse");
  lobe_in(folder, "solve scene.json --mesh finer.vtu -o fine");
  const std::string coarse = "coarse/solution.vtu ", fine = "fine/solution.vtu ";
  const Json same = Json::parse(lobe_in(folder, "compare --json " + fine + fine).out);
  CHECK(same["relative_l2"] == 0);
  CHECK(same["same_mesh"] == true);
  CHECK(same["weight"] == "mass");
  const Ended other = lobe_in(folder, "compare --json " + coarse + fine);
  REQUIRE_MESSAGE(other.status == 0, other.err);
  const Json found = Json::parse(other.out);
  CHECK(found["same_mesh"] == false);
  CHECK(found["relative_l2"] > 0.01);  // linear tetrahedra on two cells are too stiff in bending …
  CHECK(found["relative_l2"] < 0.5);   // … by a third or so
  CHECK(found["outside_fraction"] == 0);
  CHECK(contains(lobe_in(folder, "compare " + coarse + fine).out, "different meshes: 0 % of B"));
  for (const std::string& wrong : {"beam.vtu " + fine, fine + "scene.json", fine + "missing.vtu"}) {
    const Ended refused = lobe_in(folder, "compare " + wrong);
    CHECK(refused.status == 2);
    CHECK(refused.out.empty());
    CHECK(refused.err.starts_with("lobe: error: "));
  }
}

TEST_CASE("pictures that cannot be drawn are a warning that says how to draw them later") {
  const Folder folder;
  Json scene = small_scene();
  scene["output"]["pictures"] = {0.1};
  write_scene_files(folder, scene);
  const Ended run = lobe_in(folder, "run scene.json -o out", "PATH=/nowhere");
  CHECK(run.status == 0);
  CHECK(contains(run.err, "to draw them later: lobe-picture out/pictures.json"));
  CHECK(fs::exists(folder.path / "out" / "pictures.json"));
  CHECK(lobe_in(folder, "run scene.json -o out --no-pictures", "PATH=/nowhere").err.empty());
}

#ifdef LOBE_DRAWS_PICTURES
TEST_CASE("lobe-picture draws what a run asks for") {
  const Folder folder;
  Json scene = small_scene();
  scene["output"]["pictures"] = {0, 0.12, 0.3};
  write_scene_files(folder, scene);
  const Ended run = lobe_in(folder, "run scene.json -o out");
  CHECK(run.status == 0);
  CHECK_MESSAGE(run.err.empty(), run.err, run.out);
  for (const char* name : {"picture_0.png", "picture_0.12.png", "picture_0.3.png"})
    CHECK(bytes_of(folder.path / "out" / name).starts_with("\x89PNG"));
}
#endif
