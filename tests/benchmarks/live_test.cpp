// `lobe bench live`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE(
    "lobe bench live writes a row per mesh, of positive times, and one of random hands that were replayed") {
  const std::vector<Record> rows = BenchResults("live", "--quick").rows("live");
  REQUIRE(rows.size() == 3);
  for (std::size_t i = 0; i < 2; ++i)
    for (const char* time : {"bare_us", "session_us", "publish_us", "seal_us", "keep_us", "answer_p50_ms"})
      CHECK((std::isfinite(number(rows[i], time)) && number(rows[i], time) > 0));
  CHECK(number(rows[2], "random_commands") > 700);
  CHECK(number(rows[2], "random_returns") > 0);
}
