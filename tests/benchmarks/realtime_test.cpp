// `lobe bench realtime` and `lobe bench features`.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "folder.h"

using namespace lobe::test;

namespace {

using Record = std::map<std::string, std::string>;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

// The rows of DIR/NAME.csv by column, after `lobe bench NAME ARGUMENTS -o DIR`.
std::vector<Record> rows_of(const std::string& name, const std::string& arguments) {
  const Folder folder;
  const std::string command =
      LOBE_BIN_DIR "/lobe bench " + name + ' ' + arguments + " -o '" + folder.path.string() + "' >/dev/null";
  REQUIRE(std::system(command.c_str()) == 0);
  std::istringstream csv(bytes_of(folder.path / (name + ".csv")));
  std::string line;
  REQUIRE(std::getline(csv, line));
  const std::vector<std::string> columns = cells_of(line);
  std::vector<Record> rows;
  while (std::getline(csv, line)) {
    const std::vector<std::string> cells = cells_of(line);
    REQUIRE(cells.size() == columns.size());
    Record& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i) row[columns[i]] = cells[i];
  }
  return rows;
}

}  // namespace

TEST_CASE("lobe bench realtime plays the shipped gesture to its end and says what the time step gains") {
  const std::vector<Record> rows = rows_of("realtime", "--quick --threads 2");
  REQUIRE(rows.size() == 2);
  for (const Record& row : rows) {
    CHECK(row.at("tets") == "10299");
    CHECK(row.at("status").starts_with("done"));
    CHECK(std::stod(row.at("wall_s_per_s")) > 0);
    CHECK(std::stod(row.at("limit_gain")) > 2);  // 2/ω_max over the height of the flattest tetrahedron/c
    CHECK(std::stod(row.at("limit_gain")) ==
          doctest::Approx(std::stod(row.at("limit_us")) / std::stod(row.at("wave_step_us"))).epsilon(1e-2));
    CHECK(std::stod(row.at("mass_scaling_gain")) > 1.05);
    CHECK(std::stod(row.at("local_step_gain")) > 1);
    CHECK(std::stod(row.at("dt_us")) < std::stod(row.at("limit_us")));
  }
  CHECK(rows[0].at("threads") == "1");
  CHECK(rows[1].at("threads") == "2");
}

TEST_CASE("lobe bench features times each feature on and off") {
  const std::vector<Record> rows = rows_of("features", "--quick --tets 384");
  CHECK(rows.size() > 10);
  for (const Record& row : rows) {
    INFO(row.at("feature"));
    CHECK(std::stod(row.at("off_ns_per_tet")) > 0);
    CHECK(std::stod(row.at("ratio")) ==
          doctest::Approx(std::stod(row.at("on_ns_per_tet")) / std::stod(row.at("off_ns_per_tet")))
              .epsilon(1e-2));
  }
}
