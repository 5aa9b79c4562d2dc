// `lobe bench own_pairs` and `lobe bench own_steps`.
#include <doctest/doctest.h>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench own_pairs finds no energy that grows by own steps") {
  const BenchResults results("own_pairs", "--quick");
  int by_own_steps = 0;
  for (const Record& row : results.rows("own_pairs")) {
    CHECK(number(row, "blew_up") == 0);
    CHECK(number(row, "gained") == 0);
    by_own_steps += row.at("steps") == "own" && number(row, "evaluations") < 0.9;
  }
  CHECK(by_own_steps >= 2);
}

TEST_CASE(
    "lobe bench own_steps goes where one step for all goes, with fewer evaluations beside a stiff part") {
  const BenchResults results("own_steps", "--quick");
  for (const Record& row : results.rows("own_steps")) {
    CHECK(number(row, "difference") < 0.02);
    CHECK(number(row, "gain") > 0);
    if (row.at("case") == "alike") CHECK(number(row, "evaluations") == 1);
    if (row.at("case") == "tumour") CHECK(number(row, "evaluations") < 0.8);
  }
}
