// Pages of the documentation, for tests.
#pragma once

#include <filesystem>
#include <string>

#include "folder.h"

namespace lobe::test {

// The page `name`.md of a folder with its chapters: the pages in the folder `name` beside it.
inline std::string page_with_chapters(const std::filesystem::path& docs, const std::string& name) {
  std::string text = bytes_of(docs / (name + ".md"));
  std::error_code no_chapters;
  for (const auto& entry : std::filesystem::directory_iterator(docs / name, no_chapters))
    text += bytes_of(entry.path());
  return text;
}

}  // namespace lobe::test
