#include "benchmarks/timing.h"

#include <algorithm>
#include <ctime>

namespace lobe::bench {
namespace {

double now(bool one_thread) {
  timespec time{};
  clock_gettime(one_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds_per_call(const Timed& function, double least) {
  function.call();  // its data into the caches
  const Stopwatch watch(function.one_thread), wall(false);
  int calls = 0;
  do {
    function.call();
    ++calls;
  } while (wall.seconds() < least);
  return watch.seconds() / calls;
}

}  // namespace

Stopwatch::Stopwatch(bool one_thread) : one_thread_(one_thread), start_(now(one_thread)) {}

double Stopwatch::seconds() const { return now(one_thread_) - start_; }

std::vector<std::vector<double>> sample_rounds(const std::vector<Timed>& functions,
                                               const Sampling& sampling) {
  std::vector<std::vector<double>> samples(functions.size());
  for (const Timed& function : functions) function.call();
  for (int round = 0; round < sampling.rounds; ++round)
    for (std::size_t i = 0; i < functions.size(); ++i)
      samples[i].push_back(seconds_per_call(functions[i], sampling.seconds));
  return samples;
}

std::vector<std::vector<double>> sample_in_turn(const std::vector<Timed>& functions,
                                                const Sampling& sampling) {
  auto samples = sample_rounds(functions, sampling);
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
