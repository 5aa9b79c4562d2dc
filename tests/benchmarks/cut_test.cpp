// `lobe bench cut`.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "folder.h"

using namespace lobe::test;

TEST_CASE("lobe bench cut writes a row per region, size and batch, of positive times and small errors") {
  const Folder folder;
  const std::string results = (folder.path / "results").string();
  REQUIRE(std::system(
              (LOBE_BIN_DIR "/lobe bench cut --tets 384,2000 -o '" + results + "' >/dev/null").c_str()) == 0);
  std::istringstream csv(bytes_of(folder.path / "results" / "cut.csv"));
  std::string line;
  REQUIRE(std::getline(csv, line));
  CHECK(line.starts_with("region,tets,batch,us_per_tet,rebuild_us,error"));
  int rows = 0;
  while (std::getline(csv, line)) {
    INFO(line);
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 7);
    CHECK((cells[0] == "nonlinear" || cells[0] == "tensor-mass" || cells[0] == "precomputed"));
    CHECK((std::isfinite(std::stod(cells[3])) && std::stod(cells[3]) > 0));
    CHECK(std::stod(cells[4]) > std::stod(cells[3]));
    CHECK(std::stod(cells[5]) <= 1e-5);
    ++rows;
  }
  CHECK(rows == 2 * (3 + 3 + 2));
}
