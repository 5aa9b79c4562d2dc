// `lobe bench hybrid`.
#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

#include "folder.h"

using namespace lobe::test;

TEST_CASE("lobe bench hybrid writes both representations of each linear part, with one error") {
  const Folder folder;
  const std::string results = (folder.path / "results").string();
  REQUIRE(std::system((LOBE_BIN_DIR "/lobe bench hybrid --quick -o '" + results + "' >/dev/null").c_str()) ==
          0);
  std::istringstream csv(bytes_of(folder.path / "results" / "hybrid.csv"));
  std::string line, last_error;
  REQUIRE(std::getline(csv, line));
  CHECK(line.starts_with(
      "organ,tets,linear_fraction,representation,step_us,svk_step_us,speedup,error_l2,error_free,error_max"));
  int rows = 0;
  while (std::getline(csv, line)) {
    INFO(line);
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 14);
    CHECK(cells[3] == (rows % 2 == 0 ? "precomputed" : "tensor-mass"));
    CHECK(std::stod(cells[4]) > 0);
    CHECK(std::stod(cells[6]) == doctest::Approx(std::stod(cells[5]) / std::stod(cells[4])).epsilon(1e-3));
    if (rows % 2 == 1) CHECK(cells[7] == last_error);
    CHECK((std::stod(cells[7]) > 1e-3 && std::stod(cells[7]) < 0.1));
    CHECK((rows % 2 == 1 || (std::stod(cells[13]) > 0 && std::stod(cells[13]) < 0.1)));
    last_error = cells[7];
    ++rows;
  }
  CHECK(rows == 6);
}
