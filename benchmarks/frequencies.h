// A part of `lobe bench hybrid`: the lowest natural frequencies of reduced bodies at rest, against those of
// all their tetrahedra. An error of a frequency becomes one of phase after a release.
#pragma once

#include "benchmarks/benchmarks.h"

namespace lobe::bench {

// Of scenes with automatic regions, as bench_gestures(); with cells of several sizes and other λ/μ. Prints,
// and writes DIR/frequencies.csv.
void bench_frequencies(const Options& options);

}  // namespace lobe::bench
