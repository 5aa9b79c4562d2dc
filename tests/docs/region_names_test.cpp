// Scenes, their schema and reference, the viewer's page and its protocol name the models of regions as
// region_model_names does.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "lobe/fem/body.h"
#include "lobe/scene/schema.h"
#include "pages.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const std::vector<std::string> names(region_model_names.begin(), region_model_names.end());

std::string source(const char* file) { return bytes_of(std::filesystem::path(LOBE_SOURCE_DIR) / file); }

// Each name between two texts, with commas.
std::string listed(const std::string& before, const std::string& after) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + before + name + after;
  return list;
}

}  // namespace

TEST_CASE("the schema of scenes has the models' names, and the reference lists them") {
  const auto schema = nlohmann::json::parse(scene_schema());
  CHECK(schema["definitions"]["region"]["properties"]["model"]["enum"].get<std::vector<std::string>>() ==
        names);
  const std::string reference = page_with_chapters(LOBE_SOURCE_DIR "/docs", "scene");
  CHECK(reference.find("| `model` | " + listed("`\"", "\"`") + " |") != std::string::npos);
}

TEST_CASE("the viewer's page has the models' names, by their numbers") {
  const std::string text = source("view/page/colours.js");
  const std::size_t begin = text.find("export const models = ["), end = text.find("\n];", begin);
  REQUIRE(end != std::string::npos);
  std::vector<std::string> keys;
  const std::string mark = "key: '";
  for (std::size_t at = begin; (at = text.find(mark, at)) < end;) {
    at += mark.size();
    keys.push_back(text.substr(at, text.find('\'', at) - at));
  }
  CHECK(keys == names);
}

TEST_CASE("the viewer's protocol lists the models' names") {
  CHECK(source("docs/live_protocol.md").find("becomes " + listed("`", "`") + ";") != std::string::npos);
}
