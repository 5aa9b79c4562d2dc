#include "benchmarks/validation/swing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace lobe::validation {
namespace {

constexpr double around = 0.02, top = 0.01, earliest = 0.02, apart = 0.03;  // [s]

struct Extremum {
  double time = 0, value = 0;
};

// Of the parabola a + b j + c j² that fits 2k + 1 samples around sample i best.
Extremum top_of_parabola(std::span<const double> x, int i, int k, double interval) {
  double sum = 0, first = 0, second = 0, squares = 0, fourths = 0;
  for (int j = -k; j <= k; ++j) {
    const double value = x[std::size_t(i + j)];
    sum += value;
    first += j * value;
    second += j * j * value;
    squares += j * j;
    fourths += j * j * j * j;
  }
  const int n = 2 * k + 1;
  const double b = first / squares;
  const double c = (n * second - squares * sum) / (n * fourths - squares * squares);
  const double a = (sum - c * squares) / n;
  if (c == 0) return {i * interval, a};  // level
  return {(i - b / (2 * c)) * interval, a - b * b / (4 * c)};
}

std::vector<Extremum> extrema(std::span<const double> x, double interval) {
  const int reach = std::max(1, int(std::lround(around / interval)));
  const int k = std::max(1, int(std::lround(top / interval)));
  std::vector<Extremum> found;
  for (int i = reach; i + reach < int(x.size()) && int(found.size()) <= swings_read; ++i) {
    if (i * interval <= earliest) continue;
    if (!found.empty() && i * interval - found.back().time < apart) continue;
    const auto [low, high] = std::minmax_element(x.begin() + i - reach, x.begin() + i + reach + 1);
    if (x[std::size_t(i)] == *low || x[std::size_t(i)] == *high)
      found.push_back(top_of_parabola(x, i, k, interval));
  }
  return found;
}

}  // namespace

bool shows_swings(std::span<const double> x, double interval) {
  return extrema(x, interval).size() == swings_read + 1;
}

Swing swing(std::span<const double> x, double interval) {
  const std::vector<Extremum> e = extrema(x, interval);
  if (e.size() != swings_read + 1) throw std::runtime_error("the motion has too few swings");
  const double first = std::abs(e[1].value - e[0].value);
  const double last = std::abs(e[swings_read].value - e[swings_read - 1].value);
  const double decrement = std::log(first / last) / (swings_read - 1);
  return {e[0].value, (e[swings_read].time - e[0].time) / swings_read,
          decrement / std::hypot(std::numbers::pi, decrement)};
}

}  // namespace lobe::validation
