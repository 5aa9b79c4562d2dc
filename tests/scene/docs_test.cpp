// The reference of scenes, docs/scene.md with its chapters, agrees with the code.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "lobe/scene/read_scene.h"
#include "lobe/scene/schema.h"
#include "pages.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

const std::string reference = page_with_chapters(LOBE_DOCS_DIR, "scene");

bool mentions(const std::string& text) { return reference.find(text) != std::string::npos; }

void check_keys(const json& schema) {
  if (!schema.is_structured()) return;
  if (schema.is_object() && schema.contains("properties")) {
    for (const auto& [key, property] : schema["properties"].items()) {
      CAPTURE(key);
      CHECK((mentions("`" + key + "`") || mentions("\"" + key + "\":")));
    }
  }
  for (const json& part : schema) check_keys(part);
}

}  // namespace

TEST_CASE("the reference's complete example is a scene") {
  const std::size_t start = reference.find("```json\n") + 8;
  const Scene scene = parse_scene(reference.substr(start, reference.find("```", start) - start));
  CHECK(scene.tools.size() == 2);
}

TEST_CASE("the reference's smallest example is a scene") {
  const std::size_t start = reference.find("`{\"mesh\"") + 1;
  CHECK_NOTHROW(parse_scene(reference.substr(start, reference.find('`', start) - start)));
}

TEST_CASE("the reference mentions every key of the schema") { check_keys(json::parse(scene_schema())); }
