// `lobe bench skin`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench skin writes a row per skin, of positive times") {
  const std::vector<Record> rows = BenchResults("skin", "--quick").rows("skin");
  CHECK(rows.size() == 2);
  for (const Record& row : rows) {
    CHECK(number(row, "triangles") == 2 * number(row, "vertices") - 4);  // a closed surface without holes
    for (const char* time : {"build_ms", "update_ns", "update_double_ns", "copy_ns", "follow_us"})
      CHECK((std::isfinite(number(row, time)) && number(row, time) > 0));
  }
}
