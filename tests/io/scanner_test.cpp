#include "lobe/file/scanner.h"

#include <clocale>
#include <cmath>
#include <limits>

#include "io/fixture.h"
#include "lobe/io/numeric.h"

using lobe::io::Scanner;

TEST_CASE("words, numbers and comments are read across lines of either kind") {
  Scanner scan("f", "Vertices 3\r\n# a comment 9\n +1.5 -2e-3#glued\n\t7", '#');
  CHECK(scan.word("a keyword") == "Vertices");
  CHECK(scan.integer("a number") == 3);
  CHECK(scan.real("a number") == 1.5);
  CHECK(scan.real("a number") == -2e-3);
  CHECK(scan.integer("a number", 0, 7) == 7);
  CHECK(scan.at_end());
}

TEST_CASE("faults name file, line and what was expected") {
  Scanner scan("f.mesh", "1\n2\nx1 99");
  scan.word("");
  scan.word("");
  CHECK_CONTAINS(fixture::fault_of([&] { scan.real("a coordinate"); }),
                 "f.mesh:3: 'x1', expected a coordinate, a number");
  CHECK_CONTAINS(fixture::fault_of([&] { scan.integer("a vertex", 1, 8); }),
                 "f.mesh:3: a vertex is 99, expected 1 … 8");
  CHECK_CONTAINS(fixture::fault_of([&] { scan.word("a face"); }), "the file ends where a face is expected");
}

TEST_CASE("a count that the rest of the file cannot hold is refused") {
  Scanner scan("f", "9000000000000000000 1 2 3");
  CHECK_CONTAINS(fixture::fault_of([&] { scan.count("points", 6); }), "but only 6 bytes follow");
  Scanner negative("f", "-1");
  CHECK_CONTAINS(fixture::fault_of([&] { negative.count("points", 6); }), "expected 0 or more");
}

TEST_CASE("numbers do not depend on the locale, and extreme ones saturate") {
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  Scanner scan("f", "1.25 1e-999 -1e999 nan");
  CHECK(scan.real("") == 1.25);
  CHECK(scan.real("") == 0);
  CHECK(scan.real("") == -std::numeric_limits<double>::infinity());
  CHECK(std::isnan(scan.real("")));
  std::setlocale(LC_ALL, "C");
}

TEST_CASE("binary numbers are read in either byte order and never beyond the end") {
  Scanner scan("f", std::string_view("\x01\x00\x00\x00\x00\x00\x00\x01\x02", 9));
  scan.set_binary(false);
  CHECK(scan.binary<std::int32_t>("a number") == 1);
  scan.set_binary(true);
  CHECK(scan.binary<std::int32_t>("a number") == 1);
  CHECK_CONTAINS(fixture::fault_of([&] { scan.binary<std::int32_t>("a number"); }),
                 "f: byte 8: the file ends within a number");
}

TEST_CASE("whole numbers are told from fractions, NaN and what is out of range") {
  using lobe::io::whole_number;
  CHECK(whole_number(3, 0, 3) == 3);
  CHECK_FALSE(whole_number(4, 0, 3));
  CHECK_FALSE(whole_number(1.5, 0, 3));
  CHECK_FALSE(whole_number(std::nan(""), 0, 3));
  CHECK_FALSE(whole_number(0, 0, -1));
}
