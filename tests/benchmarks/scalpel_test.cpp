// `lobe bench scalpel`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"
#include "benchmarks/scalpel.h"

using namespace lobe::test;

TEST_CASE(
    "lobe bench scalpel writes what a cut costs, what it leaves of the time step, and how a slit beam "
    "bends") {
  const BenchResults results("scalpel", "--quick");
  const std::vector<Record> costs = results.rows("scalpel");
  CHECK(costs.size() == 2);
  for (const Record& row : costs) {
    CHECK(number(row, "copies") > 0);
    CHECK(number(row, "frames") > 0);
    CHECK(number(row, "frames") < 60);                         // the blade begins and ends outside
    CHECK(number(row, "world_bytes") > number(row, "bytes"));  // grains are among what is allocated
    CHECK(number(row, "error") < 1e-5);
    for (const char* figure : {"geometry_us", "all_us", "single_us", "frame_ms", "step_ratio", "bytes"})
      CHECK((std::isfinite(number(row, figure)) && number(row, figure) > 0));
  }
  const std::vector<Record> edits = results.rows("scalpel_precomputed");
  REQUIRE(edits.size() == 1);
  CHECK(number(edits[0], "error") < 1e-5);
  CHECK(number(edits[0], "tet_us") > number(costs[0], "all_us"));  // the condensed matrix is corrected
  const std::vector<Record> limits = results.rows("scalpel_limit");
  CHECK(limits.size() == 4);  // two livers, with the floor and without
  CHECK(number(limits[0], "worst_limit") > 0.7);
  CHECK(number(limits[0], "most_added") < 0.01);
  CHECK(number(limits[2], "planes") == 12);
  CHECK(number(limits[2], "most_added") < 0.011);  // above the 1 % that is aimed at, in one cut
  CHECK(number(limits[3], "most_added") == 0);
  const std::vector<Record> beams = results.rows("scalpel_beam");
  CHECK(beams.size() == 1);
  CHECK(number(beams[0], "whole_m") < number(beams[0], "cut_m"));
  CHECK(number(beams[0], "cut_m") <
        1.001 * number(beams[0], "conforming_m"));  // stiffer, as a coarser mesh is
}

TEST_CASE("the orders of sags that follow powers of the cells are found to a hundredth") {
  std::vector<lobe::bench::BeamRow> rows;
  for (int n = 1; n <= 4; ++n) {
    lobe::bench::BeamRow& row = rows.emplace_back();
    row.cell_mm = 10.0 / n;
    row.cut = 0.03 - 0.002 * std::pow(row.cell_mm, 0.75);
    row.conforming = 0.03 - 0.001 * std::pow(row.cell_mm, 0.92);
  }
  const lobe::bench::SagOrders found = lobe::bench::fit_orders(rows);
  CHECK(std::abs(found.cut - 0.75) < 1e-9);
  CHECK(std::abs(found.conforming - 0.92) < 1e-9);
  CHECK(std::abs(found.limit - 0.03) < 1e-9);
  CHECK(found.rms < 1e-12);
  CHECK(std::abs(found.least - 0.75) < 1e-9);
  CHECK(std::abs(found.most - 0.92) < 1e-9);
}
