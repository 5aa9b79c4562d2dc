#include "benchmarks/timing.h"

#include <algorithm>
#include <chrono>

namespace lobe::bench {
namespace {

double seconds_per_call(const std::function<void()>& function, double least) {
  using Clock = std::chrono::steady_clock;
  function();  // its data into the caches
  const Clock::time_point start = Clock::now();
  double elapsed = 0;
  int calls = 0;
  while (elapsed < least) {
    function();
    ++calls;
    elapsed = std::chrono::duration<double>(Clock::now() - start).count();
  }
  return elapsed / calls;
}

}  // namespace

std::vector<std::vector<double>> sample_in_turn(const std::vector<std::function<void()>>& functions,
                                                const Sampling& sampling) {
  std::vector<std::vector<double>> samples(functions.size());
  for (const auto& function : functions) function();
  for (int round = 0; round < sampling.rounds; ++round)
    for (std::size_t i = 0; i < functions.size(); ++i)
      samples[i].push_back(seconds_per_call(functions[i], sampling.seconds));
  for (std::vector<double>& s : samples) std::sort(s.begin(), s.end());
  return samples;
}

double median(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}

double relative_spread(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return (sorted[n - 1 - n / 4] - sorted[n / 4]) / median(sorted);
}

}  // namespace lobe::bench
