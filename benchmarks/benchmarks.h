// The benchmarks behind `lobe bench NAME -o DIR`. Each checks its results, prints a table, and writes
// DIR/NAME.csv, DIR/NAME.gp (gnuplot) and DIR/machine.txt.
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace lobe::bench {

struct Options {
  std::filesystem::path output;  // made if it does not exist
  std::vector<int> tets;         // numbers of tetrahedra; empty: the benchmark's own
  bool quick = false;            // below 60 s, less precise
  int threads = 1;               // if above 1, it is timed beside one thread
};

// A kernel whose result is not the reference's (it is not timed), or failed rows of the validation.
class WrongResult : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Benchmark {
  const char* name;
  const char* help;
  void (*run)(const Options& options);  // throws InputError, WrongResult
};

std::span<const Benchmark> all_benchmarks();

void bench_kernels(const Options& options);
void bench_validation(const Options& options);

void write_file(const std::filesystem::path& file, const std::string& text);  // throws InputError

}  // namespace lobe::bench
