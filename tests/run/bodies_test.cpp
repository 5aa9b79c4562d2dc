// A run of two bodies: frames and report tell them apart.
#include <doctest/doctest.h>

#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
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
