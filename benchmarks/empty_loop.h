// What the machine itself does to a loop at 1 kHz: a thread that sleeps until the next millisecond, and does
// nothing else.
#pragma once

#include "lobe/haptic/loop.h"

namespace lobe::bench {

// Adds to times. Returns whether SCHED_FIFO was allowed with that priority; 0: an ordinary thread.
bool time_empty_loop(int priority, double seconds, LoopTimes& times);

}  // namespace lobe::bench
