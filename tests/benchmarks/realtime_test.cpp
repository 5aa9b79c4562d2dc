// `lobe bench realtime` and `lobe bench features`.
#include <doctest/doctest.h>

#include "benchmarks/bench_results.h"
#include "near.h"

using namespace lobe::test;

TEST_CASE("lobe bench realtime plays the shipped gesture to its end and says what the time step gains") {
  const BenchResults results("realtime", "--quick --threads 2");
  const std::vector<Record> rows = results.rows("realtime");
  REQUIRE(rows.size() == 2);
  for (const Record& row : rows) {
    CHECK(row.at("tets") == "10299");
    CHECK(row.at("status").starts_with("done"));
    CHECK(std::stod(row.at("wall_s_per_s")) > 0);
    CHECK(std::stod(row.at("limit_gain")) > 2);  // 2/ω_max over the height of the flattest tetrahedron/c
    CHECK(std::stod(row.at("limit_gain")) ==
          near(std::stod(row.at("limit_us")) / std::stod(row.at("wave_step_us")), 1e-2));
    CHECK(std::stod(row.at("local_step_gain")) > 1);
    CHECK(std::stod(row.at("dt_us")) < std::stod(row.at("limit_us")));
  }
  CHECK(rows[0].at("threads") == "1");
  CHECK(rows[1].at("threads") == "2");
  const std::vector<Record> resting = results.rows("resting");
  REQUIRE(resting.size() == 2);
  for (const Record& row : resting) {
    CHECK(number(row, "gain") == near(number(row, "awake_s_per_s") / number(row, "asleep_s_per_s"), 1e-2));
    CHECK(number(row, "error") < 1e-3);
  }
}

TEST_CASE("lobe bench features times each feature on and off") {
  const std::vector<Record> rows = BenchResults("features", "--quick --tets 384").rows("features");
  CHECK(rows.size() > 10);
  for (const Record& row : rows) {
    INFO(row.at("feature"));
    CHECK(std::stod(row.at("off_ns_per_tet")) > 0);
    CHECK(std::stod(row.at("ratio")) ==
          near(std::stod(row.at("on_ns_per_tet")) / std::stod(row.at("off_ns_per_tet")), 1e-2));
#if defined(NDEBUG) && !defined(LOBE_SANITIZED)
    // It halves the time. A compiler that vectorised it badly once made it three times as long.
    if (row.at("feature") == "selective mass") CHECK(std::stod(row.at("ratio")) < 1);
#endif
  }
}
