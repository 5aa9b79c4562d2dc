// The schema and the reference of scenes say what the tables of keys say.
#include "lobe/scene/key_table.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>

#include "lobe/scene/material_keys.h"
#include "lobe/scene/scene_keys.h"
#include "lobe/scene/schema.h"
#include "lobe/scene/tool_kinds.h"
#include "pages.h"
#include "scene/schema_of_keys.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class... Structs>
struct Tables {
  // Calls visit(definition, schema) for each table.
  template <class Visit>
  static void for_each_schema(const Visit& visit) {
    (visit(keys::table_of<Structs>.definition, schema_of<Structs>()), ...);
  }
  // Calls visit(row) for the start of each row of the pages.
  template <class Visit>
  static void for_each_row(const Visit& visit) {
    (keys::for_each_key(keys::table_of<Structs>, [&](const auto& row) { visit(row_in_words<Structs>(row)); }),
     ...);
  }
};
using All = Tables<SceneBody, Region, AutoRegions, SceneGesture, Time, Output, Boundary, ContactSetup,
                   ObstacleSetup, PronyTerm, TieSetup>;
using ByExample = Tables<Selector, FibreField, RigidShape>;  // which the pages show by examples

template <class Value>
struct Innermost {
  using Type = Value;
};
template <class Value>
requires requires { typename Value::value_type; }
struct Innermost<Value> : Innermost<typename Value::value_type> {};

// Calls visit(Tables<Struct>()) for a struct, and for those that are in it.
template <class Struct, class Visit>
void for_each_table(const Visit& visit) {
  visit(Tables<Struct>());
  keys::for_each_key(keys::table_of<Struct>, [&](const auto& row) {
    using Inner = typename Innermost<keys::MemberType<Struct, decltype(row.member)>>::Type;
    if constexpr (keys::HasKeys<Inner> && !std::same_as<Inner, Selector>) for_each_table<Inner>(visit);
  });
}
template <class Visit>
void for_each_table_of_forces(const Visit& visit) {
  const Scene none;
  for_each_kind(none, [&]<class Force>(const std::vector<Force>&) { for_each_table<Force>(visit); });
}

}  // namespace

// With LOBE_RENEW it writes the file, which is compiled into the next build.
TEST_CASE("the schema has what the tables of keys say") {
  const ordered_json file = ordered_json::parse(scene_schema());
  ordered_json renewed = file;
  const auto compare = [&](const std::string& name, const ordered_json& schema) {
    CAPTURE(name);
    CHECK(file["definitions"].value(name, ordered_json()) == schema);
    renewed["definitions"][name] = schema;
  };
  All::for_each_schema(compare);
  ByExample::for_each_schema(compare);
  for_each_table_of_forces([&](const auto& tables) { tables.for_each_schema(compare); });
  // Of these the tables have some keys, and the file the others, and what goes together.
  const auto compare_keys = [&]<class Struct>(const Struct&, const auto&... table) {
    (compare(table.definition, completed<Struct>(file["definitions"][table.definition], table)), ...);
  };
  compare_keys(Material(), keys::material_keys);
  ordered_json kinds = ordered_json::array();
  for_each_kind_in_scenes([&]<class Said>(const Said&) {
    compare(Said::type, schema_of_tool<Said>());
    kinds.push_back(reference(Said::type));
  });
  compare("tool", {{"type", "object"}, {"oneOf", kinds}});
  const ordered_json scene = completed<Scene>(file, keys::scene_keys);
  CHECK(file["properties"] == scene["properties"]);
  CHECK(file["required"] == scene["required"]);
  renewed["properties"] = scene["properties"];
  CHECK(std::string(scene_schema()) == as_text(renewed) + "\n");
  if (std::getenv("LOBE_RENEW"))
    std::ofstream(LOBE_DOCS_DIR "/../lib/lobe/scene/scene.schema.json") << as_text(renewed) << "\n";
}

TEST_CASE("rows of the reference begin as the tables of keys say") {
  const std::string pages = without_links(page_with_chapters(LOBE_DOCS_DIR, "scene"));
  const auto find = [&](const PageRow& row) {
    CAPTURE(row.start);
    CAPTURE(row.sentence);
    CHECK(row.is_on(pages));
  };
  All::for_each_row(find);
  for_each_table_of_forces([&](const auto& tables) { tables.for_each_row(find); });
  const auto find_all = [&]<class Struct>(const Struct&, const auto&... table) {
    const auto find_key = [&](const auto& row) { find(row_in_words<Struct>(row)); };
    (keys::for_each_key(table, find_key), ...);
  };
  find_all(Scene(), keys::scene_keys);
  for_each_kind_in_scenes([&]<class Said>(const Said&) {
    keys::for_each_key(keys::table_of<Said>, [&](const auto& row) {
      if (row.key != std::string("name") && row.key != std::string("path")) find(row_in_words<Said>(row));
    });
  });
  const auto is_of_law = [](const std::string& key) {  // these have a table of their own
    return std::any_of(std::begin(law_rows), std::end(law_rows), [&](const LawRow& law) {
      return std::any_of(law.keys.begin(), law.keys.end(), [&](const char* k) { return k && k == key; });
    });
  };
  keys::for_each_key(keys::material_keys, [&](const auto& row) {
    if (!is_of_law(row.key)) find(row_in_words<Material>(row));
  });
}

TEST_CASE("rows say types, ranges, units and defaults") {
  std::vector<std::string> starts;
  Tables<Time>::for_each_row([&](const PageRow& row) { starts.push_back(row.start); });
  REQUIRE(starts.size() == 14);
  CHECK(starts[1] == "\n| `frame` | number > 0 [s] | 1/30 | ");
  CHECK(starts[3] == "\n| `safety` | number in (0, 1] | 0.9 | ");
  CHECK(starts[5] == "\n| `selective_mass` | integer in [1, 16] | 1 | ");
  CHECK(starts[8] == "\n| `precision` | `\"single\"`, `\"double\"` | `\"single\"` | ");
  const PageRow row{"\n| `a` | number | ", "meaning", false};
  CHECK(row.is_on("\n| `a` | number | none | meaning of it |"));
  CHECK_FALSE(row.is_on("\n| `a` | number | none | another meaning |"));
}
