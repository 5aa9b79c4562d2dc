#include "benchmarks/timing.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

using namespace lobe::bench;

TEST_CASE("median and spread of samples of known values") {
  CHECK(median({1, 2, 4}) == 2);
  CHECK(median({1, 2, 4, 8}) == 3);
  CHECK(relative_spread({1, 2, 4, 6, 9}) == 1);
  CHECK(relative_spread({3}) == 0);
}

// A function that waits takes wall time and none of the processor, however slow the machine is.
TEST_CASE("functions are sampled in turn, as often as asked, by the clock that suits them") {
  std::string calls;
  const auto wait = [&](char name) {
    calls += name;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };
  const auto samples = sample_in_turn({{[&] { wait('a'); }, true}, {[&] { wait('b'); }, false}}, {5, 0.002});
  REQUIRE(samples.size() == 2);
  for (const auto& s : samples) {
    CHECK(s.size() == 5);
    CHECK(std::is_sorted(s.begin(), s.end()));
  }
  CHECK(samples[1].front() >= 0.02);
  CHECK(samples[0].front() < 0.02);
  // To warm up, then in each round each once more to warm up, and once for its sample, which is long enough.
  std::string expected = "ab";
  for (int round = 0; round < 5; ++round) expected += "aabb";
  CHECK(calls == expected);
}

TEST_CASE("what takes less than a sample is called until it has lasted as long") {
  int calls = 0;
  const auto samples = sample_in_turn({{[&] { ++calls; }, false}}, {1, 0.01});
  const int warm_up = 2;
  CHECK((calls - warm_up) * samples[0][0] >= 0.01 * (1 - 1e-12));
}
