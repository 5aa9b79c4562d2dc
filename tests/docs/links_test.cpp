// Links between files of the project.
#include <doctest/doctest.h>

#include <regex>

#include "documents.h"

using namespace lobe::test;
namespace fs = std::filesystem;

namespace {

// The targets of [text](target) and ![text](target) that are files, without their anchors.
std::vector<std::string> linked_files(const std::string& markdown) {
  static const std::regex link(R"(\]\(([^)#\s]+)(#[^)\s]*)?\))");
  std::vector<std::string> files;
  for (std::sregex_iterator at(markdown.begin(), markdown.end(), link), end; at != end; ++at)
    if (const std::string target = (*at)[1]; target.find("://") == std::string::npos) files.push_back(target);
  return files;
}

}  // namespace

TEST_CASE("links to files are found in Markdown") {
  const auto files = linked_files("[a](b.md#c), ![d](e/f.png), [g](https://h.i/j.md), [k](#l)");
  CHECK(files == std::vector<std::string>{"b.md", "e/f.png"});
}

TEST_CASE("every link between files of the project leads somewhere") {
  int links = 0;
  for (const fs::path& document : documents())
    for (const std::string& file : linked_files(bytes_of(document))) {
      CAPTURE(document);
      CAPTURE(file);
      CHECK(fs::exists(document.parent_path() / file));
      ++links;
    }
  CHECK(links > 50);
}
