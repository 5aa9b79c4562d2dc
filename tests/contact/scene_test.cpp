// Probes and contact as a scene says them.
#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;

namespace {

std::string scene_with(const std::string& rest) {
  return R"({"mesh": "a.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}], )" + rest + "}";
}

std::string message(const std::string& rest) {
  try {
    resolve(parse_scene(scene_with(rest)), box_mesh({0.03, 0.03, 0.03}, 3, 3, 3));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string with_probe(const std::string& what) {
  return R"("tools": [{"type": "probe", "path": [[0, 0.01, 0.01, 0.04]], )" + what + "}]";
}

// Of a ball of 4 mm radius on a path.
std::vector<std::string> warnings_of(const std::string& path) {
  const std::string tool =
      R"("tools": [{"type": "probe", "shape": {"sphere": {"radius": 0.004}}, "path": [)" + path + "]}]";
  const TetMesh mesh = box_mesh({0.03, 0.03, 0.03}, 3, 3, 3);
  const Scene scene = parse_scene(scene_with(R"("time": {"duration": 9}, )" + tool));
  std::vector<std::string> warnings = resolve(scene, mesh).warnings;
  std::erase_if(warnings, [](const std::string& text) { return !text.starts_with("/tools"); });
  return warnings;
}

}  // namespace

TEST_CASE("every shape of a probe, obstacles and self contact are read, written and read again") {
  const std::string text = scene_with(R"(
    "tools": [
      {"type": "probe", "shape": {"sphere": {"radius": 0.005}}, "path": [[0, 0.01, 0.01, 0.05], [1, 0.01, 0.01, 0.03]]},
      {"type": "probe", "name": "shaft", "shape": {"capsule": {"radius": 0.004, "length": 0.1}}, "friction": 0,
       "release": true, "path": [[0, 0.01, 0.01, 0.05, 0, 0, 1, 0]]},
      {"type": "probe", "shape": {"box": {"size": [0.01, 0.02, 0.03]}}, "path": [[0, 0.01, 0.01, 0.05]]},
      {"type": "probe", "shape": {"jaws": {"size": [0.008, 0.004, 0.02]}}, "friction": 0.5,
       "path": [[0, 0.01, 0.01, 0.05, 0.012], [1, 0.01, 0.01, 0.05, 0, 0, 0, 1, 0.004]]},
      {"type": "probe", "path": [[0, 0.01, 0.01, 0.05]], "shape": {"mesh": {
         "points": [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]],
         "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}}}],
    "contact": {"self": true, "friction": 0.2, "damping": 0.1, "obstacles": [
      {"name": "table", "shape": {"plane": {}}, "position": [0, 0, -0.1], "friction": 0.4},
      {"shape": {"box": {"size": [1, 1, 1]}}, "orientation": [0, 0, 1, 0]}]})");
  const Scene scene = parse_scene(text), again = parse_scene(to_json(scene));
  for (const Scene& read : {scene, again}) {
    const Setup setup = resolve(read, box_mesh({0.03, 0.03, 0.03}, 3, 3, 3)).setup;
    REQUIRE(setup.probes.size() == 5);
    CHECK(setup.probes[0].shape == RigidShape::sphere(0.005));
    CHECK(setup.probes[0].friction == default_friction);
    CHECK(setup.probes[1].shape == RigidShape::capsule(0.004, 0.1));
    CHECK(setup.probes[1].friction == 0);
    CHECK(setup.probes[1].release);
    CHECK(setup.probes[1].path[0].orientation == Eigen::Vector4d(0, 0, 1, 0));
    CHECK(setup.probes[2].shape == RigidShape::box({0.01, 0.02, 0.03}));
    CHECK(setup.probes[3].path[0].opening == 0.012);
    CHECK(setup.probes[3].path[1].opening == 0.004);
    CHECK(setup.probes[4].shape.triangles.size() == 4);
    CHECK(setup.contact.self);
    CHECK(setup.contact.friction == 0.2);
    CHECK(setup.contact.damping == 0.1);
    REQUIRE(setup.contact.obstacles.size() == 2);
    CHECK(setup.contact.obstacles[0].shape == RigidShape::plane());
    CHECK(setup.contact.obstacles[0].position == Vec3d(0, 0, -0.1));
    CHECK(setup.contact.obstacles[0].friction == 0.4);
    CHECK(setup.contact.obstacles[1].orientation == Eigen::Vector4d(0, 0, 1, 0));
  }
}

TEST_CASE("what a probe or an obstacle cannot be is named, with its place") {
  CHECK(message(with_probe(R"("shape": {"sphere": {"radius": 0}})")) ==
        "/tools/0/shape/sphere/radius: 0, must be above 0");
  CHECK(message(with_probe(R"("shape": {"sphere": {"radius": 0.01}}, "friction": -0.1)")) ==
        "/tools/0/friction: -0.1, must be at least 0");
  CHECK(message(R"("contact": {"friction": -1})") == "/contact/friction: -1, must be at least 0");
  CHECK(message(with_probe(R"("shape": {"mesh": {"points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
                "triangles": [[0,1,2],[0,1,3],[0,3,2],[1,2,3]]}})"))
            .starts_with("/tools/0/shape: it needs a closed surface"));
  CHECK(message(with_probe(R"("shape": {"mesh": {"file": "not_there.obj"}})")).find("not_there.obj") !=
        std::string::npos);
  CHECK(message(R"("contact": {"obstacles": [{"shape": {"plane": {}}, "orientation": [0, 0, 0, 2]}]})") ==
        "/contact/obstacles/0/orientation: the quaternion has length 2, must be 1");
  CHECK(message(R"("time": {"integrator": "implicit"}, "contact": {"self": true})")
            .find("does not go with \"integrator\": \"implicit\"") != std::string::npos);
}

TEST_CASE("a probe that begins inside the organ is warned of, and one that only comes there later is not") {
  const std::vector<std::string> inside = warnings_of("[0, 0.011, 0.012, 0.014], [1, 0.011, 0.012, 0.05]");
  REQUIRE(inside.size() == 1);
  CHECK(inside[0] ==
        "/tools/0/path/0: the probe begins inside the organ: it pushes at once, or not at all where it "
        "touches no surface. Begin outside");
  CHECK(warnings_of("[0, 0.011, 0.012, 0.033], [1, 0.011, 0.012, 0.02]").empty());
}

TEST_CASE(
    "a probe that goes more than a quarter of its radius in a step is warned of, with its fastest row") {
  // Cells of 10 mm, the Kuhn tetrahedra of which are 10 mm / √2 high, and waves of 7.75 m/s: steps of
  // 0.9 · 0.913 ms. So 1 mm, a quarter of the radius, is reached at 1.22 m/s.
  const std::vector<std::string> fast = warnings_of(
      "[0, 0.011, 0.012, 0.2], [0.1, 0.011, 0.012, 0.1], [0.12, 0.011, 0.012, 0.075], [0.2, 0.011, 0.012, "
      "0.032]");
  REQUIRE(fast.size() == 1);
  CHECK(
      fast[0] ==
      "/tools/0/path/2: the probe goes there at 1.25 m/s, about 0.001027 m in a step, more than a quarter of "
      "its radius, 0.004 m: it may leap into the organ or through it");
  CHECK(warnings_of("[0, 0.011, 0.012, 0.152], [0.1, 0.011, 0.012, 0.032]").empty());
}
