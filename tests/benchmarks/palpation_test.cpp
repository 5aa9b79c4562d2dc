// `lobe bench palpation`.
#include <doctest/doctest.h>

#include <map>

#include "benchmarks/bench_results.h"

using namespace lobe::test;

TEST_CASE("lobe bench palpation writes a force that grows with depth, and is largest over the tumour") {
  const BenchResults results("palpation", "--quick");
  std::map<std::string, double> last, deepest;
  for (const Record& row : results.rows("palpation")) {
    const std::string curve = row.at("place") + ' ' + row.at("tumour");
    CHECK(number(row, "force_N") >= last[curve]);
    last[curve] = number(row, "force_N");
    deepest[curve] = number(row, "indentation_mm");
  }
  REQUIRE(last.size() == 6);
  for (const auto& [curve, depth] : deepest) CHECK(depth == 7);
  for (const auto& [curve, force] : last)
    if (curve != "over the tumour yes") CHECK(last["over the tumour yes"] > 1.5 * force);
}
