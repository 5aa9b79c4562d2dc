#include "benchmarks/benchmarks.h"

#include "lobe/io/atomic_file.h"

namespace lobe::bench {

std::span<const Benchmark> all_benchmarks() {
  static constexpr Benchmark list[] = {
      {"kernels", "cost per tetrahedron of each force kernel, against a plain loop", bench_kernels},
      {"validation", "known solutions, orders of convergence, conserved quantities", bench_validation},
  };
  return list;
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  io::AtomicFile out(file);
  out.stream() << text;
  out.commit();
}

}  // namespace lobe::bench
