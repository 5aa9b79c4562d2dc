// `lobe bench hybrid`.
#include <doctest/doctest.h>

#include "benchmarks/bench_results.h"
#include "near.h"

using namespace lobe::test;

TEST_CASE("lobe bench hybrid writes both representations of each linear part, with one error, and gestures") {
  const BenchResults results("hybrid", "--quick");
  const std::vector<Record> rows = results.rows("hybrid");
  CHECK(rows.size() == 6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Record& row = rows[i];
    CHECK(row.at("representation") == (i % 2 == 0 ? "precomputed" : "tensor-mass"));
    CHECK(number(row, "step_us") > 0);
    CHECK(number(row, "frame_step_us") > 0);
    CHECK(number(row, "speedup") == near(number(row, "svk_step_us") / number(row, "step_us"), 1e-3));
    if (i % 2 == 1) CHECK(row.at("error_l2") == rows[i - 1].at("error_l2"));
    CHECK((number(row, "error_l2") > 1e-3 && number(row, "error_l2") < 0.1));
    CHECK((i % 2 == 1 || (number(row, "error_transient") > 0 && number(row, "error_transient") < 0.1)));
  }
  const std::vector<Record> gestures = results.rows("gestures");
  REQUIRE(gestures.size() >= 5);
  CHECK(gestures[0].at("regions") == "nonlinear");
  double recipe = 1, proposed = 0;  // share of the tetrahedra, for the same error in equilibrium
  for (const Record& row : gestures) {
    CAPTURE(row.at("regions"));
    CHECK(number(row, "speedup") > 0);
    CHECK(number(row, "mean_error") <= number(row, "largest_error"));
    if (row.at("regions") == "strain-recipe") recipe = number(row, "linear_share");
    if (row.at("regions") == "proposed") proposed = number(row, "linear_share");
    if (row.at("regions") == "strain-recipe" || row.at("regions") == "proposed")
      CHECK(number(row, "static_error") <= number(row, "tolerance"));
    if (row.at("regions").ends_with("corrected")) {
      CHECK(number(row, "moved") + number(row, "expanded") > 0);
      CHECK(number(row, "mean_error") < 0.02);  // the scene's tolerance
    }
  }
  CHECK(proposed > 1.5 * recipe);
}
