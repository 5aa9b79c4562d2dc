#include "benchmarks/timing.h"

#include <doctest/doctest.h>

#include <chrono>

using namespace lobe::bench;

TEST_CASE("median and spread of samples of known values") {
  CHECK(median({1, 2, 4}) == 2);
  CHECK(median({1, 2, 4, 8}) == 3);
  CHECK(relative_spread({1, 2, 4, 6, 9}) == 1);
  CHECK(relative_spread({3}) == 0);
}

TEST_CASE("functions are sampled in turn and one that does more takes longer") {
  const auto wait = [](int microseconds) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::microseconds(microseconds);
    while (Clock::now() < end) {
    }
  };
  const auto samples = sample_in_turn({[&] { wait(50); }, [&] { wait(500); }}, {5, 0.002});
  REQUIRE(samples.size() == 2);
  for (const auto& s : samples) CHECK(s.size() == 5);
  CHECK(samples[0].front() >= 50e-6);
  CHECK(samples[1].front() >= 500e-6);
}
