// `lobe bench haptic`.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE(
    "lobe bench haptic writes an error per prediction, and the times of each loop with their histograms") {
  const BenchResults results("haptic", "--quick");
  std::map<std::string, double> at_20_hz;
  for (const Record& row : results.rows("haptic")) {
    CHECK((std::isfinite(number(row, "rms")) && number(row, "rms") > 0));
    CHECK(number(row, "rms") <= number(row, "max"));
    if (number(row, "frame_hz") == 20) at_20_hz[row.at("method")] = number(row, "rms");
  }
  REQUIRE(at_20_hz.size() == 9);
  // What the paper's group found in 1999.
  CHECK(at_20_hz["constant"] > at_20_hz["linear in time"]);
  CHECK(at_20_hz["linear in time"] > at_20_hz["linear in position"]);
  const auto loops = results.rows("haptic_loop");
  REQUIRE(loops.size() >= 2);
  for (const Record& row : loops) {
    CHECK(number(row, "compute_p50_us") > 0);
    CHECK(number(row, "late_p50_us") <= number(row, "late_max_us"));
    CHECK(number(row, "real_time_factor") > 0);
  }
  CHECK(results.rows("haptic_histogram").size() > 20);
}
