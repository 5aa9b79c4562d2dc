// explain() agrees with a validator (valijson): on every value of a scene replaced, removed or renamed, one
// refuses exactly when the other has something to say.
#include <doctest/doctest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "lobe/scene/explain.h"
#include "lobe/scene/schema.h"
#include "scene/scenes.h"
#include "scene/validator.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

const std::vector<json> replacements = {nullptr,
                                        true,
                                        false,
                                        0,
                                        1,
                                        -1,
                                        0.5,
                                        -0.5,
                                        1.5,
                                        2,
                                        1e300,
                                        -3000000000,
                                        3000000000,
                                        18446744073709551615.0,
                                        "",
                                        "x",
                                        "grasp",
                                        "cautery",
                                        "scalpel",
                                        "single",
                                        json::array(),
                                        json::object(),
                                        {1, 2, 3},
                                        {1, 2, 3, 4},
                                        {0, "x", 0},
                                        {5, 6, 5},
                                        json::object({{"all", true}}),
                                        json::object({{"all", true}, {"label", 1}})};

void compare(const json& document, int& refused) {
  static const json schema = json::parse(scene_schema());
  const std::vector<Fault> faults = explain(document, schema);
  const bool satisfied = satisfies_scene_schema(document);
  if (satisfied != faults.empty()) {
    CAPTURE(document.dump());
    CHECK(satisfied == faults.empty());
  }
  refused += !satisfied;
}

}  // namespace

TEST_CASE("the validator refuses exactly what has an explanation") {
  const json scene = json::parse(full_scene);
  const json flat = scene.flatten();
  std::set<std::string> pointers = {""};
  for (const auto& [pointer, value] : flat.items()) {
    for (std::size_t end = pointer.find('/', 1); end != std::string::npos; end = pointer.find('/', end + 1)) {
      pointers.insert(pointer.substr(0, end));
    }
    pointers.insert(pointer);
  }
  int refused = 0, documents = 0;
  for (const std::string& text : pointers) {
    const json::json_pointer pointer(text);
    for (const json& value : replacements) {
      json changed = scene;
      changed[pointer] = value;
      compare(changed, refused);
      ++documents;
    }
    if (text.empty()) continue;
    json removed = scene;
    json& parent = removed[pointer.parent_pointer()];
    const json value = scene[pointer];
    if (parent.is_object()) {
      parent.erase(pointer.back());
      compare(removed, refused);
      parent[pointer.back() + "x"] = value;
    } else {
      parent.push_back(value);
    }
    compare(removed, refused);
  }
  CHECK(documents > 3000);
  CHECK(refused > documents / 2);
  CHECK(refused < documents);
}

TEST_CASE("a fault is explained once, without noise") {
  json scene = json::parse(full_scene);
  scene["boundary"][0]["where"]["all_of"][0]["all"] = 3;
  const std::vector<Fault> faults = schema_faults(scene, "scene.json");
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].place == "/boundary/0/where/all_of/0/all");
  CHECK(faults[0].message == "3, must be true");
}

TEST_CASE("lists without repetitions are so for both") {
  json scene = json::parse(full_scene);
  int refused = 0;
  for (const json& copies : {json{5, 6, 7}, json{5, 6, 5}, json{1, 1.0}, json{1, "1"}}) {
    scene["tools"][0]["copies"] = copies;
    compare(scene, refused);
  }
  CHECK(refused == 3);
}
