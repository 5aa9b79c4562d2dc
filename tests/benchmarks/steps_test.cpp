// `lobe bench steps`.
#include <doctest/doctest.h>

#include <map>

#include "benchmarks/bench_results.h"
#include "benchmarks/step_chains.h"

using namespace lobe::test;

TEST_CASE("lobe bench steps finds own steps stable, and two levels with nothing between them not") {
  const BenchResults results("steps", "--quick");
  std::map<std::string, double> grew;
  for (const Record& row : results.rows("steps")) {
    const std::string part = row.at("part") + ", " + row.at("scheme");
    if (row.at("part") == "order") {
      if (row.at("scheme") == "own steps") CHECK(number(row, "order") > 1.9);
      continue;
    }
    grew[part] += number(row, "grew");
    if (part == "chains, own steps") CHECK(number(row, "evaluations") < 0.65);
    if (part == "blocks, own steps" && number(row, "damping_1_s") == 0) {
      CHECK(number(row, "momentum") < 1e-13);
      CHECK(number(row, "angular_momentum") < 1e-12);
    }
  }
  CHECK(grew.at("chains, own steps") == 0);
  CHECK(grew.at("blocks, own steps") == 0);
  CHECK(grew.at("chains, two levels with nothing between") > 0);
  CHECK(grew.at("chains, leapfrog-Chebyshev 0.05") == 0);
}

TEST_CASE("stages of leapfrog-Chebyshev: T_p, its slope at 1 + ν/p², and the known interval without ν") {
  using namespace lobe::bench;
  const StageFactors plain = stage_factors(3, 0);  // T_3'(1) = 9: the interval is 4 p²
  CHECK(plain.T == std::vector<double>{1, 1, 1, 1});
  CHECK(plain.alpha == 18);
  CHECK(plain.longest() == 36);
  const double d = 1 + 0.1 / 9;
  const StageFactors damped = stage_factors(3, 0.1);
  CHECK(std::abs(damped.T[3] - (4 * d * d * d - 3 * d)) < 1e-14);
  CHECK(std::abs(damped.alpha - 2 * (12 * d * d - 3) / damped.T[3]) < 1e-13);
  CHECK(fewest_stages(5.9, 1, 0).T.size() == 4);
}
