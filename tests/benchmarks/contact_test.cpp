// `lobe bench contact`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench contact writes a row per case; contact does not shorten the step") {
  const std::vector<Record> rows = BenchResults("contact", "--quick").rows("contact");
  CHECK(rows.size() == 11);
  for (const Record& row : rows) {
    CHECK((std::isfinite(number(row, "step_us")) && number(row, "step_us") > 0));
    const bool touches = row.at("contact").starts_with("touching");
    const bool has_lips = row.at("contact") == "self with a slit while swinging";
    CHECK((number(row, "force_N") > 0) == touches);
    if (!has_lips) CHECK((number(row, "touched_vertices") > 0) == touches);
    CHECK(number(row, "limit") >= 0.99);
  }
}
