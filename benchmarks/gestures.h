// The second part of `lobe bench hybrid`: scenes with automatic regions, played with regions of several
// makings beside the body that is all non-linear.
#pragma once

#include "benchmarks/benchmarks.h"

namespace lobe::bench {

// Of those scenes that have automatic regions. Prints, and writes DIR/gestures.csv, if there are any. Returns
// what gnuplot is to do with it.
std::string bench_gestures(const Options& options);

}  // namespace lobe::bench
