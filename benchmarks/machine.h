// Where a benchmark ran: figures without it cannot be read.
#pragma once

#include <filesystem>
#include <string>

namespace lobe::bench {

// Makes DIR, prints machine_line(), and notes it in DIR/machine.txt, a line for each benchmark that wrote
// there. Returns it.
std::string begin_results(const std::filesystem::path& directory, const std::string& benchmark);

// "AMD EPYC, 2 hardware threads; GCC 12.2.0, avx2; 2026-01-31 12:00 UTC, load 0.5"
std::string machine_line();

// What this program has in memory now [bytes]; 0 where that cannot be asked for. Freed memory is given back
// first.
double resident_bytes();

// What it has allocated now [bytes], to the byte, with what the allocator adds; 0 where that cannot be asked
// for.
double allocated_bytes();

}  // namespace lobe::bench
