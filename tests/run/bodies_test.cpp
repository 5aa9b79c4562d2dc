// A run of two bodies: frames and report tell them apart.
#include <doctest/doctest.h>

#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe_command.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Json two_boxes = Json::parse(R"({
  "bodies": [{"name": "below", "mesh": "box.vtu"},
             {"name": "above", "mesh": "box.vtu", "position": [0.005, 0, 0.0205]}],
  "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
  "boundary": [{"fix": true, "where": {"all_of": [{"body": "below"},
    {"box": {"min": [-1, -1, -1], "max": [1, 1, 0]}}]}}],
  "gravity": [0, 0, -9.81],
  "contact": {"self": true},
  "time": {"duration": 0.2, "frame": 0.02, "damping": 20},
  "output": {"every": 0.1}
})");

struct Played {
  Folder folder;
  Json report;

  explicit Played(const Json& document) {
    write_vtu(folder.path / "box.vtu", box_mesh({0.04, 0.03, 0.02}, 3, 2, 2));
    const Scene scene = read_scene(folder.write("scene.json", document.dump()));
    CHECK(run_scene(scene, resolve(scene, read_scene_mesh(scene).mesh),
                    {folder.path / "out", 1, {}, make_ldlt, false, {}})
              .ok);
    report = report_in(folder.path / "out");
  }
};

}  // namespace

TEST_CASE("a report has mass, place and energies of each body, which add up to those of the world") {
  const Played played(two_boxes);
  for (const Json& state : played.report["series"]) {
    const Json& bodies = state["bodies"];
    REQUIRE(bodies.size() == 2);
    CHECK(bodies[0]["name"] == "below");
    CHECK(bodies[1]["tetrahedra"] == 72);
    const auto sum = [&](const char* energy) {
      return bodies[0]["energy"][energy].get<double>() + bodies[1]["energy"][energy].get<double>();
    };
    if (state["time"] > 0)
      CHECK(sum("elastic") == near(state["energy"]["elastic_nonlinear"].get<double>(), 1e-3));
    CHECK(bodies[0]["volume"].get<double>() + bodies[1]["volume"].get<double>() ==
          near(state["volume"].get<double>(), 1e-9));
  }
  // The upper one has fallen by the gap, and rests on the lower one.
  const double fallen = played.report["series"].front()["bodies"][1]["centre"][2].get<double>() -
                        played.report["series"].back()["bodies"][1]["centre"][2].get<double>();
  CHECK(fallen > 0.0004);
  CHECK(fallen < 0.002);
}

TEST_CASE("frames have the body of each cell") {
  const Played played(two_boxes);
  const MeshFile frame = read_mesh(played.folder.path / "out/frame_0002.vtu");
  const Eigen::MatrixXd& body = frame.cell_data.at("body");
  for (Index t = 0; t < frame.mesh.tet_count(); ++t) CHECK(body(0, t) == (t < 72 ? 0 : 1));
}

TEST_CASE("frames of a blade's cut have the body of each cell") {
  Json document = two_boxes;
  document["tools"] = Json::parse(R"([{"type": "scalpel",
    "path": [[0.02, 0.02, -0.01, 0.01, 0.02, -0.01, 0.05], [0.06, 0.02, 0.04, 0.01, 0.02, 0.04, 0.05]]}])");
  const Played played(document);
  const MeshFile frame = read_mesh(played.folder.path / "out/frame_0002.vtu");
  REQUIRE(frame.cell_data.contains("parent"));
  REQUIRE(frame.mesh.tet_count() > 144);
  for (Index t = 0; t < frame.mesh.tet_count(); ++t)
    CHECK(frame.cell_data.at("body")(0, t) == (frame.cell_data.at("parent")(0, t) < 72 ? 0 : 1));
}

TEST_CASE("a scene of one mesh has neither") {
  const Folder folder;
  const RunResult result = play(write_scene_files(folder), folder.path / "out");
  CHECK(result.ok);
  CHECK_FALSE(report_in(folder.path / "out")["series"][0].contains("bodies"));
  CHECK_FALSE(read_mesh(folder.path / "out/frame_0000.vtu").cell_data.contains("body"));
}

TEST_CASE("a run does not remove the meshes of its bodies from its folder") {
  const Folder folder;
  write_vtu(folder.path / "frame_0001.vtu", box_mesh({0.04, 0.03, 0.02}, 3, 2, 2));
  Json document = two_boxes;
  for (Json& body : document["bodies"]) body["mesh"] = "frame_0001.vtu";
  const Scene scene = read_scene(folder.write("scene.json", document.dump()));
  const Resolved resolved = resolve(scene, read_scene_mesh(scene).mesh);
  CHECK_THROWS_AS(run_scene(scene, resolved, {folder.path, 1, {}, make_ldlt, false, {}}), InputError);
}

TEST_CASE("lobe check judges what is held of several bodies") {
  const Folder folder;
  write_vtu(folder.path / "box.vtu", box_mesh({0.04, 0.03, 0.02}, 3, 2, 2));
  Json scene = two_boxes;
  folder.write("loose.json", scene.dump());
  const Ended loose = lobe_in(folder, "check loose.json --total-error");
  CHECK(loose.status == 2);
  CHECK(loose.err.find("is not held") != std::string::npos);
  scene["boundary"][0]["where"] = Json::parse(R"({"any_of": [
    {"all_of": [{"body": "below"}, {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}]},
    {"all_of": [{"body": "above"}, {"box": {"min": [-1, -1, -1], "max": [0.012, 1, 1]}}]}]})");
  folder.write("scene.json", scene.dump());
  const Ended held = lobe_in(folder, "check scene.json --total-error --json");
  REQUIRE_MESSAGE(held.status == 0, held.err);
  const Json weight = Json::parse(held.out)["total_error"][0];
  CHECK_FALSE(weight.contains("held_trouble"));
  CHECK(weight["element"]["relative_l2"].get<double>() > 0.01);
  // The upper one is held 1/150 m further on the refined mesh.
  CHECK(weight["held"]["relative_l2"].get<double>() > 0.1);
  const Ended solved = lobe_in(folder, "solve scene.json --quadratic -o out");
  CHECK_MESSAGE(solved.status == 0, solved.err);
  CHECK(solved.err.find("contact is ignored in a static solution") != std::string::npos);
}

TEST_CASE("lobe check judges what is held by surfaces that the file names: the same body") {
  const Folder folder;
  const TetMesh mesh = box_mesh({0.06, 0.02, 0.02}, 6, 2, 2);
  std::string triangles;
  int count = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (const auto& corners : face_corners) {
      bool is_left = true;
      std::string line;
      for (const int c : corners) {
        is_left = is_left && mesh.points(0, mesh.tets(c, t)) == 0;
        line += std::to_string(mesh.tets(c, t) + 1) + ' ';
      }
      if (!is_left) continue;
      triangles += line + "7\n";
      ++count;
    }
  REQUIRE(count == 8);
  std::string text =
      "MeshVersionFormatted 2\nDimension 3\nVertices " + std::to_string(mesh.vertex_count()) + '\n';
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    for (int axis = 0; axis < 3; ++axis) text += std::to_string(mesh.points(axis, v)) + ' ';
    text += "0\n";
  }
  text += "Triangles " + std::to_string(count) + '\n' + triangles;
  text += "Tetrahedra " + std::to_string(mesh.tet_count()) + '\n';
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (const Index v : mesh.tets.col(t)) text += std::to_string(v + 1) + ' ';
    text += "0\n";
  }
  folder.write("beam.mesh", text + "End\n");
  Json scene = small_scene();
  scene["mesh"] = "beam.mesh";
  scene["regions"] = Json::array({{{"model", "nonlinear"}}});
  scene["boundary"][0]["where"] = {{"surface", "7"}};
  scene["tools"] = Json::array();
  folder.write("scene.json", scene.dump());
  const Ended ended = lobe_in(folder, "check scene.json --total-error --json");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  const Json weight = Json::parse(ended.out)["total_error"][0];
  CHECK_FALSE(weight.contains("held_trouble"));
  CHECK(weight["held"]["relative_l2"].get<double>() < 1e-8);
  CHECK(weight["total"]["relative_l2"].get<double>() ==
        near(weight["element"]["relative_l2"].get<double>(), 1e-6));
}
