// The part of lobe bench soak that plays sessions as long as a day's work.
#pragma once

#include "benchmarks/benchmarks.h"

namespace lobe::bench {

// Plays sessions of a small body: in one nothing is done, in one a hand leads a grasp, in one a hand takes a
// grasp after the other, in one three hands do whatever can be done. Prints a table and writes it to
// DIR/soak_sessions.csv: what they have in memory, and the processor time of their frames. Throws WrongResult
// if a replay gives other bits.
void soak_sessions(const Options& options);

}  // namespace lobe::bench
