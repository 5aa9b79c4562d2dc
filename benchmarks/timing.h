// Times that a busy machine disturbs little: short samples of all kernels in turn, and their medians. What
// runs on one thread is timed by that thread's processor time, which leaves out the time slices of other
// programs; what runs on several by the wall clock.
#pragma once

#include <functional>
#include <vector>

namespace lobe::bench {

// From its making on: processor time of this thread, or wall time. [s]
class Stopwatch {
 public:
  explicit Stopwatch(bool one_thread);
  double seconds() const;

 private:
  bool one_thread_;
  double start_;
};

struct Sampling {
  int rounds = 11;        // samples of each kernel
  double seconds = 0.02;  // least duration of one sample
};

struct Timed {
  std::function<void()> call;
  bool one_thread = true;
};

// Calls every function once to warm up, then again and again for one sample each, in turn, round after round.
// Returns the samples of each, by rounds: seconds per call.
std::vector<std::vector<double>> sample_rounds(const std::vector<Timed>& functions, const Sampling& sampling);
// The same, sorted.
std::vector<std::vector<double>> sample_in_turn(const std::vector<Timed>& functions,
                                                const Sampling& sampling);

double median(const std::vector<double>& sorted);
double relative_spread(const std::vector<double>& sorted);  // (third − first quartile) / median

}  // namespace lobe::bench
