// What a scene says of a scalpel.
#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;

namespace {

Scene scene_with(const std::string& blade, const std::string& time = "{}") {
  return parse_scene(
      R"({"mesh": "m.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "fracture_energy": 120}],
    "regions": [{"model": "nonlinear"}], "tools": [{"type": "scalpel", )" +
          blade + R"(}], "time": )" + time + "}",
      "scene.json");
}

Resolved with_blade(const std::string& blade) {
  return resolve(scene_with(blade), box_mesh(Vec3d::Constant(0.1), 5, 5, 5));
}

std::string fault_of_blade(const std::string& blade) {
  try {
    with_blade(blade);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool blade_warns(const std::string& blade, const std::string& text) {
  for (const std::string& warning : with_blade(blade).warnings)
    if (warning.find(text) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("a blade that is the same all along is said once, and is the same tool") {
  const Scene shorter =
      scene_with(R"("blade": [0, 0, 0.04], "path": [[0.5, 0.03, -0.05, 0.01], [1, 0.03, 0.05, 0.01]])");
  const Scene longer = scene_with(
      R"("path": [[0.5, 0.03, -0.05, 0.01, 0.03, -0.05, 0.05], [1, 0.03, 0.05, 0.01, 0.03, 0.05, 0.05]])");
  const SceneScalpel &once = shorter.tools[0].as<ScalpelSetup>(), &twice = longer.tools[0].as<ScalpelSetup>();
  REQUIRE(once.heels.size() == 2);
  for (int i = 0; i < 2; ++i) {
    CHECK((once.heels[i] - twice.heels[i]).norm() < 1e-15);
    CHECK(once.path[i].position == twice.path[i].position);
  }
}

TEST_CASE("surface, fracture energy and the step that cuts leave come from the scene, and go back into it") {
  const Scene scene =
      scene_with(R"("surface": "faces", "path": [[0, 0, 0, 0, 0, 0, 1]])", R"({"cut_step": 0.5})");
  const Scene again = parse_scene(to_json(scene), "scene.json");
  for (const Scene* each : {&scene, &again}) {
    const Setup setup = resolve(*each, box_mesh(Vec3d::Constant(0.1), 2, 2, 2)).setup;
    CHECK(setup.scalpels[0].along_faces);
    CHECK(setup.materials[0].fracture_energy == 120);
    CHECK(setup.cut_step == 0.5);
  }
  CHECK(scene_with(R"("path": [[0, 0, 0, 0, 0, 0, 1]])").tools[0].as<ScalpelSetup>().surface ==
        CutSurface::smooth);
}

TEST_CASE(
    "rows that do not fit the blade, blades without length and times that do not increase are refused") {
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(has(fault_of_blade(R"("path": [[0, 0, 0, 0]])"), "/tools/0/path/0: a row has 7 numbers"));
  CHECK(has(fault_of_blade(R"("blade": [0, 0, 1], "path": [[0, 0, 0, 0, 0, 0, 1]])"),
            "4 where there is a \"blade\""));
  CHECK(has(fault_of_blade(R"("path": [[0, 1, 2, 3, 1, 2, 3]])"),
            "/tools/0/path/0: tip and heel are the same point"));
  CHECK(has(fault_of_blade(R"("blade": [0, 0, 0], "path": [[0, 1, 2, 3]])"),
            "tip and heel are the same point"));
  CHECK(has(fault_of_blade(R"("path": [[1, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 2]])"), "/tools/0/path/1"));
  CHECK(has(fault_of_blade(R"("snap": 0.5, "path": [[0, 0, 0, 0, 0, 0, 1]])"), "/tools/0/snap"));
  CHECK(has(fault_of_blade(R"("surface": "rough", "path": [[0, 0, 0, 0, 0, 0, 1]])"), "/tools/0/surface"));
}

TEST_CASE("a blade that cuts nothing, changes its length, leaps or never comes near is warned of") {
  const std::string good =
      R"("path": [[0, 0.05, -0.1, 0.2, 0.05, 0.2, 0.2], [1, 0.05, -0.1, -0.1, 0.05, 0.2, -0.1]])";
  for (const char* text : {"cuts nothing", "length varies", "mean edges", "never comes near"})
    CHECK(!blade_warns(good, text));
  CHECK(blade_warns(R"("blade": [0, 0.01, 0], "path": [[0, 0.05, 0.05, 0.2], [1, 0.05, 0.05, -0.1]])",
                    "cuts nothing"));
  CHECK(
      blade_warns(R"("path": [[0, 0.05, -0.1, 0.2, 0.05, 0.2, 0.2], [1, 0.05, -0.1, -0.1, 0.05, 0.1, -0.1]])",
                  "length varies"));
  CHECK(blade_warns(R"("blade": [0, 0.3, 0], "path": [[0, 0.05, -0.1, 3], [0.1, 0.05, -0.1, -3]])",
                    "mean edges"));
  CHECK(blade_warns(R"("blade": [0, 0.3, 0], "path": [[0, 0.5, -0.1, 0.3], [1, 0.5, -0.1, -0.1]])",
                    "never comes near"));
  CHECK(!blade_warns(good, "wholly inside"));
  CHECK(blade_warns(
      R"("path": [[0, 0.05, 0.05, 0.02, 0.05, 0.05, 0.08], [1, 0.06, 0.05, 0.02, 0.06, 0.05, 0.08]])",
      "/tools/0/path/0: the blade begins wholly inside the body"));
}
