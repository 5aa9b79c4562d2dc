// Tables in Markdown: a row that has fewer or more cells than its header is drawn wrong, and a blank line
// ends a table.
#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

#include "documents.h"

using namespace lobe::test;
namespace fs = std::filesystem;

namespace {

// A bar begins a cell unless a backslash stands before it, also within code.
int bars_in(const std::string& row) {
  int bars = 0;
  for (std::size_t i = 0; i < row.size(); ++i) bars += row[i] == '|' && (i == 0 || row[i - 1] != '\\');
  return bars;
}

bool is_delimiter(const std::string& row) {
  return row.find("---") != std::string::npos && row.find_first_not_of("|:- ") == std::string::npos;
}

struct Faults {
  int tables = 0;
  std::string lines;  // " 3 4": of rows that fit no table
};

Faults faults_of(const std::string& markdown) {
  Faults faults;
  std::istringstream in(markdown + "\n\n");
  bool is_code = false;
  int row = 0, bars = 0, number = 0;  // row: of the table that we are in
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with("```")) is_code = !is_code;
    const bool is_row = !is_code && line.starts_with('|');
    if (!is_row && row == 1) faults.lines += ' ' + std::to_string(number - 1);  // alone
    row = is_row ? row + 1 : 0;
    if (row == 1) bars = bars_in(line);
    faults.tables += row == 1;
    if (row > 0 && (bars_in(line) != bars || is_delimiter(line) != (row == 2)))
      faults.lines += ' ' + std::to_string(number);
  }
  return faults;
}

}  // namespace

TEST_CASE("a row with a cell more or less, a table in two and one without a header are found") {
  CHECK(faults_of("| a | b |\n|---|---|\n| `x\\|y` | 1 |\n\n```\n| code |\n```\n").lines.empty());
  CHECK(faults_of("| a | b |\n|---|---|\n| 1 |\n| 1 | 2 | 3 |\n").lines == " 3 4");
  CHECK(faults_of("| a |\n|---|\n| 1 |\n\n| 2 |\n| 3 |\n").lines == " 6");
  CHECK(faults_of("| a |\n| 1 |\n").lines == " 2");
  CHECK(faults_of("| a |\n|---|\n| 1 |\n\n| 2 |").lines == " 5");
}

TEST_CASE("every row of every table has as many cells as its header") {
  int tables = 0;
  for (const fs::path& document : documents()) {
    CAPTURE(document);
    const Faults faults = faults_of(bytes_of(document));
    CHECK(faults.lines == "");
    tables += faults.tables;
  }
  CHECK(tables > 40);
}
