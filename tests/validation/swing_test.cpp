#include "benchmarks/validation/swing.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "near.h"

using namespace lobe::validation;
using namespace lobe::test;

namespace {

constexpr double interval = 0.0025;  // [s]

// Let go at 0, at rest at 1 plus drift · t, with the ratio ζ and a half period [s].
std::vector<double> let_go(double ratio, double half_period, double between, double drift = 0) {
  const double decay = ratio / std::sqrt(1 - ratio * ratio) * std::numbers::pi / half_period;  // ζω [1/s]
  std::vector<double> x;
  for (double t = 0; t < 9.5 * half_period; t += between) {
    const double phase = std::numbers::pi * t / half_period;
    const double swung = std::cos(phase) + decay * half_period / std::numbers::pi * std::sin(phase);
    x.push_back(1 + drift * t - std::exp(-decay * t) * swung);
  }
  return x;
}

}  // namespace

TEST_CASE("half period, damping ratio and peak of a damped cosine are found") {
  for (double half_period : {0.0647, 0.1146, 0.1478})
    for (double ratio : {0.01, 0.055, 0.1}) {
      const Swing found = swing(let_go(ratio, half_period, interval), interval);
      CHECK(found.half_period == near(half_period, 1e-4));
      CHECK(found.damping_ratio == near(ratio, 5e-4));
      const double decrement = std::numbers::pi * ratio / std::sqrt(1 - ratio * ratio);
      CHECK(found.first_peak == near(1 + std::exp(-decrement), 5e-4));
    }
}

TEST_CASE("a hundred samples a second are enough, and a drift of the middle does not matter") {
  const double half_period = 0.0647, ratio = 0.055;
  const Swing coarse = swing(let_go(ratio, half_period, 0.01), 0.01);
  CHECK(coarse.half_period == near(half_period, 1e-3));
  CHECK(coarse.damping_ratio == near(ratio, 1e-3));
  const Swing drifts = swing(let_go(ratio, half_period, interval, 0.1), interval);
  CHECK(drifts.half_period == near(half_period, 1e-3));
  CHECK(drifts.damping_ratio == near(ratio, 0.01));
}

TEST_CASE("a motion of too few swings is told") {
  std::vector<double> x = let_go(0.055, 0.1, interval);
  CHECK(shows_swings(x, interval));
  x.resize(std::size_t(7.5 * 0.1 / interval));
  CHECK(!shows_swings(x, interval));
  CHECK_THROWS_AS(swing(x, interval), std::runtime_error);
  CHECK_THROWS_AS(swing({}, interval), std::runtime_error);
}
