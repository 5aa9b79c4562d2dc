// A part of `lobe bench hybrid --reduced`: how long a world with a reduced region takes to set up, and how
// much memory it takes beyond one that is all non-linear.
#pragma once

#include "benchmarks/benchmarks.h"

namespace lobe::bench {

// Of the meshes that bench_frequencies() takes. Prints, and writes DIR/reduced_setup.csv.
void bench_reduced_setup(const Options& options);

}  // namespace lobe::bench
