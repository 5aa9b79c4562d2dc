// `lobe bench surface`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench surface writes a row per mesh, of positive times and few changed triangles") {
  const std::vector<Record> rows = BenchResults("surface", "--quick").rows("surface");
  CHECK(rows.size() == 3);
  for (const Record& row : rows) {
    for (const char* time : {"remove_us", "follow_us", "rebuild_us", "positions_ns", "normals_ns", "copy_ns"})
      CHECK((std::isfinite(number(row, time)) && number(row, time) > 0));
    CHECK(number(row, "changed_triangles") > 0);
    CHECK(number(row, "changed_triangles") <= 30);  // ten tetrahedra have forty faces, and share nine or more
  }
}
