// The reference's table of options that exclude each other is the one that scenes are checked against.
#include <doctest/doctest.h>

#include "lobe/setup/exclusions.h"
#include "pages.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::string cell(Option option) {
  const std::string text = name(option);
  return text.find('"') == std::string::npos ? text : "`" + text + "`";
}

std::string row(const Exclusion& exclusion, const std::string& where) {
  return "| " + cell(exclusion.option) + " | " + cell(exclusion.other) + where + " | " + exclusion.reason +
         " | " + exclusion.remedy + " |\n";
}

std::string table() {
  std::string rows = "| option | not with | because | instead |\n|---|---|---|---|\n";
  for (const Exclusion& exclusion : exclusions()) rows += row(exclusion, "");
  for (const Exclusion& exclusion : material_exclusions()) rows += row(exclusion, ", the same material");
  return rows;
}

}  // namespace

TEST_CASE("the reference of scenes shows the table of options that exclude each other") {
  const std::string text = page_with_chapters(LOBE_SOURCE_DIR "/docs", "scene");
  INFO("expected:\n", table());
  CHECK(text.find(table()) != std::string::npos);
}
