// Wall times that a busy machine disturbs little: short samples of all kernels in turn, and their medians.
#pragma once

#include <functional>
#include <vector>

namespace lobe::bench {

struct Sampling {
  int rounds = 11;        // samples of each kernel
  double seconds = 0.02;  // least duration of one sample
};

// Calls every function once to warm up, then again and again for one sample each, in turn, round after round.
// Returns the samples of each, sorted: seconds per call.
std::vector<std::vector<double>> sample_in_turn(const std::vector<std::function<void()>>& functions,
                                                const Sampling& sampling);

double median(const std::vector<double>& sorted);
double relative_spread(const std::vector<double>& sorted);  // (third − first quartile) / median

}  // namespace lobe::bench
