#include "lobe/scene/write_scene.h"

#include <doctest/doctest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/scene/check_scene.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/schema.h"
#include "scene/scenes.h"

using namespace lobe;
using nlohmann::json;

namespace {

const std::string small_scene = R"({"mesh": "a.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}]})";

// Every "default" of the schema's object against the value that the library fills in.
int compare_defaults(const json& properties, const json& written) {
  int compared = 0;
  for (const auto& [key, property] : properties.items()) {
    if (!property.contains("default")) continue;
    CAPTURE(key);
    REQUIRE(written.contains(key));
    CHECK(written[key] == property["default"]);
    ++compared;
  }
  return compared;
}

}  // namespace

TEST_CASE("a scene survives being written and read") {
  const std::string once = to_json(parse_scene(full_scene));
  CHECK(to_json(parse_scene(once)) == once);
  const json before = json::parse(full_scene), after = json::parse(once);
  for (const char* key : {"mesh", "boundary", "gravity", "time", "output", "loose_pieces"}) {
    CAPTURE(key);
    CHECK(after[key] == before[key]);
  }
  CHECK(after["regions"][2]["where"] == before["regions"][2]["where"]);
  CHECK(after["tools"][0] == before["tools"][0]);
}

TEST_CASE("automatic regions survive being written and read, and have the schema's defaults") {
  json document = json::parse(small_scene);
  document["regions"] = {{"auto",
                          {{"tolerance", 0.05},
                           {"precomputed", false},
                           {"reduced", true},
                           {"correct", true},
                           {"gestures",
                            {{{"name", "lift"}, {"where", {{"all", true}}}, {"displacement", {0, 0, 1}}},
                             {{"name", "load"}, {"where", {{"label", {1}}}}, {"force", {1, 0, 0}}}}}}}};
  CHECK(json::parse(to_json(parse_scene(document.dump())))["regions"] == document["regions"]);
  document["regions"] = {{"auto", json::object()}};
  const json written = json::parse(to_json(parse_scene(document.dump())));
  const json definition = json::parse(scene_schema())["definitions"]["auto_regions"];
  CHECK(compare_defaults(definition["properties"], written["regions"]["auto"]) == 5);
}

TEST_CASE("the schema's defaults are the library's") {
  const json schema = json::parse(scene_schema());
  const json written = json::parse(to_json(parse_scene(small_scene)));
  const json& definitions = schema["definitions"];
  CHECK(compare_defaults(schema["properties"], written) == 12);
  CHECK(compare_defaults(definitions["material"]["properties"], written["materials"][0]) == 4);
  CHECK(compare_defaults(definitions["time"]["properties"], written["time"]) == 13);
  CHECK(compare_defaults(definitions["output"]["properties"], written["output"]) == 2);
}

TEST_CASE("a scene built in code is checked like one that was read") {
  Scene scene = parse_scene(small_scene);
  CHECK_NOTHROW(check_scene(scene));
  scene.materials[0].density = -1;
  scene.gravity[2] = std::numeric_limits<double>::quiet_NaN();
  scene.regions.push_back({"", RegionModel::nonlinear, RegionFrame::fixed, 0, Selector{SelectNot{}}, ""});
  CHECK_THROWS_WITH_AS(check_scene(scene),
                       "/gravity/2: not a number, must be finite\n"
                       "/materials/0/density: -1.0, must be above 0\n"
                       "/regions/0/where/not: null, must be an object",
                       InputError);
  scene = parse_scene(small_scene);
  scene.materials[0].lame_lambda = -1e5;
  CHECK_THROWS_AS(check_scene(scene), InputError);
}

TEST_CASE("what no text of a scene can say is refused in a scene built in code") {
  const double infinite = std::numeric_limits<double>::infinity();
  Scene scene = parse_scene(small_scene);
  Boundary& moved = scene.boundary.emplace_back();  // null would let the component slide
  moved.kind = Boundary::Kind::displacement;
  moved.value[1] = std::numeric_limits<double>::quiet_NaN();
  scene.time.sleep = infinite;
  CHECK_THROWS_WITH_AS(check_scene(scene),
                       "/boundary/0/displacement/1: not a number, must be finite\n"
                       "/time/sleep: infinite, must be finite",
                       InputError);
  scene = parse_scene(small_scene);
  Selector inner{SelectAll{}};
  for (int i = 0; i < 70; ++i) inner = {SelectNot{{inner}}};
  scene.materials[0].where = inner;
  CHECK_THROWS_WITH_AS(check_scene(scene), "scene.json: nested more than 64 levels deep", InputError);
}
