// `lobe bench cut`.
#include <doctest/doctest.h>

#include <cmath>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench cut writes a row per region, size and batch, of positive times and small errors") {
  const std::vector<Record> rows = BenchResults("cut", "--tets 384,2000").rows("cut");
  for (const Record& row : rows) {
    const std::string& region = row.at("region");
    CHECK((region == "nonlinear" || region == "tensor-mass" || region.starts_with("precomputed")));
    CHECK((std::isfinite(number(row, "us_per_tet")) && number(row, "us_per_tet") > 0));
    CHECK((std::isfinite(number(row, "rebuild_us")) && number(row, "rebuild_us") > 0));
    CHECK(number(row, "error") <= 1e-5);
  }
  CHECK(rows.size() == 2 * (3 + 3 + 2) + 2);
}
