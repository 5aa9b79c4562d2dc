// Clip appliers, hooks and bodies that carry something, in scenes.
#include <doctest/doctest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/parse_tool.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "lobe/sim/world.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

struct DuctScene {
  Folder folder;

  DuctScene() { write_vtu(folder.path / "duct.vtu", box_mesh({0.02, 0.004, 0.004}, 10, 2, 2)); }

  json document() const {
    return json::parse(R"({
      "bodies": [{"name": "duct", "mesh": "duct.vtu", "carries": "bile"}],
      "materials": [{"young_modulus": 5000, "poisson_ratio": 0.4}],
      "boundary": [{"fix": true, "where": {"plane": {"point": [0.001, 0, 0], "normal": [-1, 0, 0], "side": "above"}}}],
      "tools": [
        {"type": "clip_applier", "name": "clip", "length": 0.006, "opening": 0.005, "gap": 0.002,
         "path": [[0.1, 0.01, 0.002, 0.002], [0.5, 0.012, 0.002, 0.002, 0, 0, 1, 0]]},
        {"type": "cautery", "name": "hook", "radius": 0.001, "hook": [0, 0, 0.003], "core": 0.0005,
         "path": [[0.2, 0.02, 0, 0], [0.3, 0.02, 0, 0, 0, 1, 0, 0]]}]
    })");
  }
  Scene scene(const json& text) const { return parse_scene(text.dump(), folder.path / "scene.json"); }
  Resolved resolved(const json& text) const {
    Scene read = scene(text);
    MeshFile file = read_scene_mesh(read);
    bind_groups(file, read);
    return resolve(read, std::move(file.mesh));
  }
  std::string fault(const json& patch) const {
    json text = document();
    text.merge_patch(patch);
    try {
      resolved(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

}  // namespace

TEST_CASE("a body that carries bile is fed where the scene holds it") {
  const DuctScene duct;
  const Setup setup = duct.resolved(duct.document()).setup;
  REQUIRE(setup.carriers.size() == 1);
  CHECK(setup.carriers[0].body == 0);
  CHECK(setup.carriers[0].carries == Carries::bile);
  CHECK(setup.carriers[0].fed.size() == 9);
  for (const Index v : setup.carriers[0].fed) CHECK(setup.mesh.points(0, v) == 0);
}

TEST_CASE("clips and hooks of a scene become tools, and are written as they were read") {
  const DuctScene duct;
  const Resolved resolved = duct.resolved(duct.document());
  const Setup& setup = resolved.setup;
  REQUIRE(setup.clip_appliers.size() == 1);
  CHECK(setup.clip_appliers[0].clip == ClipShape{0.006, 0.005, 0.002, 1e-3, 1000});
  CHECK(setup.clip_appliers[0].path[1].orientation == Eigen::Vector4d(0, 0, 1, 0));
  REQUIRE(setup.cauteries.size() == 1);
  CHECK(setup.cauteries[0].hook == Vec3d(0, 0, 0.003));
  CHECK(setup.cauteries[0].core == 0.0005);
  const Scene scene = duct.scene(duct.document());
  const Scene again = parse_scene(to_json(scene), duct.folder.path / "again.json");
  CHECK(to_json(again) == to_json(scene));
  CHECK(again.bodies[0].carries == Carries::bile);
  CHECK(again.tools[0].as<ClipApplierSetup>().clip == scene.tools[0].as<ClipApplierSetup>().clip);
  CHECK(again.tools[1].as<CauterySetup>().hook == scene.tools[1].as<CauterySetup>().hook);
  CHECK(again.tools[1].as<CauterySetup>().core == scene.tools[1].as<CauterySetup>().core);
}

TEST_CASE("what clips and carriers lack is named with its place") {
  const DuctScene duct;
  CHECK(duct.fault(json::object()) == "");
  CHECK(duct.fault({{"boundary", json::array()}})
            .find("/bodies/0/carries: bile comes in where a body is held, and \"duct\" is held nowhere") !=
        std::string::npos);
  json tools = duct.document()["tools"];
  tools[0]["gap"] = 0.005;
  CHECK(duct.fault({{"tools", tools}}).find("/tools/0/gap: 0.005 m, must be below the opening, 0.005 m") !=
        std::string::npos);
  tools[0]["gap"] = 0;
  CHECK(duct.fault({{"tools", tools}}).find("/tools/0/gap") != std::string::npos);
  tools = duct.document()["tools"];
  tools[1]["core"] = 0.001;
  CHECK(duct.fault({{"tools", tools}}).find("/tools/1/core: 0.001 m, must be below the radius, 0.001 m") !=
        std::string::npos);
  const std::string implicit = duct.fault({{"time", {{"integrator", "implicit"}}}});
  for (const char* place : {"/tools/0/type: a probe", "/tools/1/type: a probe"})  // a clip, a core
    CHECK(implicit.find(place) != std::string::npos);
  json bodies = duct.document()["bodies"];
  bodies[0]["carries"] = "water";
  CHECK(duct.fault({{"bodies", bodies}}).find("/bodies/0/carries") != std::string::npos);
}

TEST_CASE("a clip that closes beside the organ has a warning") {
  const DuctScene duct;
  json text = duct.document();
  text["tools"][0]["path"][1][2] = 0.05;
  const Resolved resolved = duct.resolved(text);
  REQUIRE(resolved.warnings.size() == 1);
  CHECK(resolved.warnings[0].find("/tools/0/path/1: the clip closes outside") != std::string::npos);
}

TEST_CASE("a hand brings a clip applier and a hook by their JSON") {
  const ParsedTool applier = parse_tool(
      R"({"type": "clip_applier", "length": 0.006, "opening": 0.005, "gap": 0.002, "at": [1, 2, 3, 0, 0, 1, 0]})");
  CHECK(std::get<BringClipApplier>(applier.command) ==
        BringClipApplier{"clip_applier", {0.006, 0.005, 0.002}, {1, 2, 3}, {0, 0, 1, 0}});
  const ParsedTool hook =
      parse_tool(R"({"type": "cautery", "radius": 0.001, "hook": [0, 0, 0.01], "at": [1, 2, 3]})");
  CHECK(std::get<BringCautery>(hook.command) == BringCautery{"cautery", 0.001, {1, 2, 3}, {0, 0, 0.01}});
}

TEST_CASE("a duct that is cut between clips does not leak, an artery does not bleed; without clips they do") {
  const DuctScene duct;
  json text = duct.document();
  text["time"] = {{"duration", 1.2}, {"frame", 0.02}, {"damping", 40}};
  text["tools"] = json::parse(R"([
    {"type": "scalpel", "surface": "faces", "blade": [0, 0, 0.008],
     "path": [[0.8, 0.0135, -0.002, -0.002], [1.0, 0.0135, 0.006, -0.002]]},
    {"type": "clip_applier", "name": "clip", "length": 0.0063, "opening": 0.006, "gap": 0.0026, "path": [
      [0.02, 0.0055, 0.002, 0.002, 0, 0, 0.7071067811865476, 0.7071067811865476],
      [0.22, 0.0095, 0.002, 0.002, 0, 0, 0.7071067811865476, 0.7071067811865476],
      [0.42, 0.0175, 0.002, 0.002, 0, 0, 0.7071067811865476, 0.7071067811865476]]}])");
  for (const char* carries : {"bile", "blood"})
    for (const bool is_clipped : {true, false}) {
      CAPTURE(carries);
      CAPTURE(is_clipped);
      text["bodies"][0]["carries"] = carries;
      json now = text;
      if (!is_clipped) now["tools"].erase(1);
      World<float> world(duct.resolved(now).setup);
      std::map<Event::Kind, int> events;
      int pieces = 0;
      for (int i = 0; i < 60; ++i) {
        const Report report = world.advance(0.02);
        REQUIRE(report.ok);
        for (const Event& event : report.events) ++events[event.kind];
        for (const Condition& condition : report.conditions)
          pieces += condition.kind == Condition::Kind::pieces;
      }
      CHECK(events[Event::Kind::clipped] == (is_clipped ? 3 : 0));
      const bool is_blood = std::string(carries) == "blood";
      CHECK((events[Event::Kind::bleeding] > 0) == (is_blood && !is_clipped));
      CHECK((events[Event::Kind::leak] > 0) == (!is_blood && !is_clipped));
      CHECK(pieces == 1);  // it was cut through
    }
}
