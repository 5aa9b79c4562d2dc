// Where a benchmark ran: figures without it cannot be read.
#pragma once

#include <string>

namespace lobe::bench {

// "AMD EPYC, 2 hardware threads; GCC 12.2.0, avx2; 2026-01-31 12:00 UTC, load 0.5"
std::string machine_line();

}  // namespace lobe::bench
