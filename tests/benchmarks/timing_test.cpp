#include "benchmarks/timing.h"

#include <doctest/doctest.h>

using namespace lobe::bench;

TEST_CASE("median and spread of samples of known values") {
  CHECK(median({1, 2, 4}) == 2);
  CHECK(median({1, 2, 4, 8}) == 3);
  CHECK(relative_spread({1, 2, 4, 6, 9}) == 1);
  CHECK(relative_spread({3}) == 0);
}

TEST_CASE("functions are sampled in turn, as often as asked, and one that does more takes longer") {
  volatile double sum = 0;
  const auto add = [&](int terms) {
    for (int i = 0; i < terms; ++i) sum = sum + i;
  };
  for (bool one_thread : {true, false}) {
    const auto samples =
        sample_in_turn({{[&] { add(1000); }, one_thread}, {[&] { add(100000); }, one_thread}}, {5, 0.002});
    REQUIRE(samples.size() == 2);
    for (const auto& s : samples) CHECK(s.size() == 5);
    CHECK(samples[0].front() > 0);
    CHECK(samples[1].front() > 10 * samples[0].front());
  }
}
