// `lobe bench scalpel`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE(
    "lobe bench scalpel writes what a cut costs, what it leaves of the time step, and how a slit beam "
    "bends") {
  const BenchResults results("scalpel", "--quick");
  const std::vector<Record> costs = results.rows("scalpel");
  CHECK(costs.size() == 2);
  for (const Record& row : costs) {
    CHECK(number(row, "copies") > 0);
    CHECK(number(row, "error") < 1e-5);
    for (const char* figure : {"geometry_us", "all_us", "frame_ms", "step_ratio", "bytes"})
      CHECK((std::isfinite(number(row, figure)) && number(row, figure) > 0));
  }
  const std::vector<Record> limits = results.rows("scalpel_limit");
  CHECK(limits.size() == 4);  // two livers, with the floor and without
  CHECK(number(limits[0], "worst_limit") > 0.7);
  CHECK(number(limits[0], "most_added") < 0.01);
  const std::vector<Record> beams = results.rows("scalpel_beam");
  CHECK(beams.size() == 1);
  CHECK(number(beams[0], "whole_m") < number(beams[0], "cut_m"));
  CHECK(number(beams[0], "cut_m") <
        1.001 * number(beams[0], "conforming_m"));  // stiffer, as a coarser mesh is
}
