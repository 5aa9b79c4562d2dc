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

// Files of the project that are named in `code`, with their folder.
std::vector<std::string> named_files(const std::string& markdown) {
  static const std::regex name(
      R"(`((?:benchmarks|data|examples|lib|meshing|pictures|tests|view)/[\w/.\-]+\.\w+)`)");
  std::vector<std::string> files;
  for (std::sregex_iterator at(markdown.begin(), markdown.end(), name), end; at != end; ++at)
    files.push_back((*at)[1]);
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

TEST_CASE("every file of the project that the pages name is there") {
  CHECK(named_files("`lib/lobe/a.h` and lib/b.h, `lib/lobe/c.*`") ==
        std::vector<std::string>{"lib/lobe/a.h"});
  int names = 0;
  for (const fs::path& document : documents())
    for (const std::string& file : named_files(bytes_of(document))) {
      CAPTURE(document);
      CAPTURE(file);
      CHECK(fs::exists(fs::path(LOBE_SOURCE_DIR) / file));
      ++names;
    }
  CHECK(names > 20);
}
