// Needles in scenes.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/parse_tool.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct NeedleScene {
  Folder folder;
  NeedleScene() { write_vtu(folder.path / "block.vtu", box_mesh({0.04, 0.04, 0.02}, 4, 4, 2)); }
  static nlohmann::json document() {
    return nlohmann::json::parse(R"({
      "mesh": "block.vtu", "materials": [{"young_modulus": 20000, "poisson_ratio": 0.3}],
      "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1e-6]}}}],
      "tools": [{"type": "needle", "radius": 0.01, "angle": 2, "thickness": 0.0004, "puncture": 0.3,
                 "friction": 15, "thread": 2, "thread_holds": 1.5, "release": true,
                 "path": [[0, 0.02, 0.02, 0.031, 0.5, 0.5, -0.5, 0.5], [1, 0.02, 0.02, 0.023]]}]})");
  }
  Resolved resolved(const nlohmann::json& document) const {
    Scene read = parse_scene(document.dump(), folder.path / "scene.json");
    MeshFile file = read_scene_mesh(read);
    bind_groups(file, read);
    return resolve(read, std::move(file.mesh));
  }
  std::string fault(const nlohmann::json& document) const {
    try {
      (void)resolved(document);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a needle of a scene becomes a tool, and is written as it was read") {
  const NeedleScene files;
  const Setup setup = files.resolved(files.document()).setup;
  REQUIRE(setup.needles.size() == 1);
  const NeedleSetup& needle = setup.needles[0];
  CHECK(needle.name == "needle");
  CHECK(needle.settings == NeedleSettings{{0.01, 2, 0.0004}, 0.3, 15});
  CHECK(needle.thread == 2);
  CHECK(needle.material.holds == 1.5);
  CHECK(needle.material.stiffness == ThreadMaterial{}.stiffness);
  CHECK(needle.release);
  REQUIRE(needle.path.size() == 2);
  CHECK(needle.path[0].orientation == Eigen::Vector4d(0.5, 0.5, -0.5, 0.5));
  const Scene scene = parse_scene(files.document().dump(), files.folder.path / "scene.json");
  const Scene again = parse_scene(to_json(scene), files.folder.path / "again.json");
  CHECK(to_json(again) == to_json(scene));
  CHECK(again.tools[0].as<NeedleSetup>().settings == needle.settings);
}

TEST_CASE("what a needle lacks is named with its place") {
  const NeedleScene files;
  const auto with = [&](const char* key, const nlohmann::json& value) {
    nlohmann::json document = files.document();
    document["tools"][0][key] = value;
    return files.fault(document);
  };
  CHECK(files.fault(files.document()) == "");
  CHECK(has(with("radius", 0), "/tools/0/radius: 0, must be above 0"));
  CHECK(has(with("angle", 7), "/tools/0/angle"));
  CHECK(has(with("puncture", 0), "/tools/0/puncture: 0, must be above 0"));
  CHECK(has(with("friction", -1), "/tools/0/friction: -1, must be at least 0"));
  CHECK(has(with("thickness", 0.01), "/tools/0/thickness: 0.01 m, must be below the radius, 0.01 m"));
  CHECK(has(with("thread", -1), "/tools/0/thread"));
  nlohmann::json document = files.document();
  document["tools"][0]["thread"] = 0;
  document["threads"] = {{{"stitches", {{{"through", {{0.01, 0.01, 0.01}, {0.02, 0.01, 0.01}}}}}}}};
  CHECK(has(files.fault(document), "/tools/0/thread: 0, must be at least 1: stitches of the scene"));
}

TEST_CASE("a needle that is thicker than an edge, begins inside, or stays away has a warning") {
  const NeedleScene files;
  const auto warning = [&](const nlohmann::json& change) {
    nlohmann::json document = files.document();
    document["tools"][0].update(change);
    const std::vector<std::string> warnings = files.resolved(document).warnings;
    return warnings.empty() ? std::string() : warnings.front();
  };
  CHECK(warning(nlohmann::json::object()) == "");
  CHECK(has(warning({{"radius", 0.03}, {"thickness", 0.011}, {"path", {{0, 0.02, 0.02, 0.045}}}}),
            "/tools/0/thickness: 0.011 m, above the shortest edge there, 0.01 m"));
  CHECK(has(warning({{"path", {{0, 0.02, 0.02, 0.01}}}}), "/tools/0/path/0: the needle's tip begins inside"));
  CHECK(has(warning({{"path", {{0, 0.02, 0.02, 0.5}}}}), "no row of it comes within the needle's radius"));
}

TEST_CASE("a hand brings a needle by its JSON") {
  const ParsedTool needle = parse_tool(
      R"({"type": "needle", "radius": 0.01, "puncture": 0.3, "friction": 15, "thread": 1,
          "at": [1, 2, 3, 0, 0, 1, 0]})");
  const BringNeedle& command = std::get<BringNeedle>(needle.command);
  CHECK(command.settings.shape.radius == 0.01);
  CHECK(command.thread == 1);
  CHECK(command.pose.position == Vec3d(1, 2, 3));
  CHECK(command.pose.orientation == Eigen::Vector4d(0, 0, 1, 0));
}
