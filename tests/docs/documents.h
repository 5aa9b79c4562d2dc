// The pages of documentation, for tests.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "folder.h"

namespace lobe::test {

inline std::vector<std::filesystem::path> documents() {
  namespace fs = std::filesystem;
  std::vector<fs::path> found{fs::path(LOBE_SOURCE_DIR) / "README.md"};
  for (const char* folder : {"docs", "data", "benchmarks/results"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LOBE_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".md") found.push_back(entry.path());
  return found;
}

}  // namespace lobe::test
