// The commands of `lobe` that other programs answer, where those are missing.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "folder.h"

using lobe::test::bytes_of;
using lobe::test::Folder;

TEST_CASE("lobe mesh and lobe bench name the missing program and the option that builds it, with status 2") {
  const Folder folder;
  std::filesystem::copy_file(LOBE_BIN_DIR "/lobe", folder.path / "lobe");  // with nothing beside it
  const std::filesystem::path errors = folder.path / "errors.txt";
  const char* const cases[][3] = {{"mesh", "lobe-mesh", "LOBE_MESHING=ON"},
                                  {"bench", "lobe-bench", "LOBE_BENCHMARKS=ON"}};
  for (const auto& [command, program, option] : cases) {
    const std::string line = "PATH=/nowhere '" + (folder.path / "lobe").string() + "' " + command + " x 2>'" +
                             errors.string() + "'";
    const int status = std::system(line.c_str());
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 2);
    const std::string message = bytes_of(errors);
    CHECK(message.starts_with("lobe: error: " + std::string(program) + ": not found"));
    CHECK(message.find(option) != message.npos);
    CHECK(message.find("./dev build") != message.npos);
  }
}
