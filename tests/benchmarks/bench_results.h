// What `lobe bench` writes.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "folder.h"

namespace lobe::test {

using Record = std::map<std::string, std::string>;  // a row of a table, by column

inline double number(const Record& row, const char* column) { return std::stod(row.at(column)); }

inline std::vector<std::string> cells_of(const std::string& line) {  // of a line of comma-separated values
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

// Of `lobe bench NAME ARGUMENTS`.
class BenchResults {
 public:
  BenchResults(const std::string& name, const std::string& arguments) {
    const std::string command = LOBE_BIN_DIR "/lobe bench " + name + ' ' + arguments + " -o '" +
                                folder_.path.string() + "' >/dev/null";
    REQUIRE(std::system(command.c_str()) == 0);
  }

  std::vector<Record> rows(const std::string& table) const {  // of TABLE.csv
    std::istringstream csv(bytes_of(folder_.path / (table + ".csv")));
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

 private:
  Folder folder_;
};

}  // namespace lobe::test
