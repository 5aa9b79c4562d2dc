#include <algorithm>
#include <cstdio>

#include "benchmarks/benchmarks.h"
#include "commands.h"
#include "console.h"
#include "lobe/error.h"

namespace lobe::program {
namespace {

// DIR/NAME.png by DIR/NAME.gp, if gnuplot is installed.
void plot(const std::filesystem::path& directory, const std::string& name) {
  std::string quoted;
  for (char c : directory.string()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  const int status = run_program({"gnuplot", "-e", "cd '" + quoted + "'", name + ".gp"});
  if (status == 127) print_warnings({"gnuplot is not installed: no " + name + ".png"});
  if (status != 0 && status != 127) print_warnings({"gnuplot failed: no " + name + ".png"});
}

}  // namespace

int run_benchmark(const BenchOptions& options) {
  const auto benchmarks = bench::all_benchmarks();
  const auto chosen = std::find_if(benchmarks.begin(), benchmarks.end(),
                                   [&](const bench::Benchmark& b) { return options.name == b.name; });
  if (chosen == benchmarks.end()) {
    std::string message = "no such benchmark; there are:";
    for (const bench::Benchmark& b : benchmarks) message += std::string("\n  ") + b.name + ": " + b.help;
    throw InputError("bench " + options.name, message);
  }
  if (!chosen->takes_scenes && !(options.scenes.empty() && options.meshes.empty()))
    throw InputError("bench " + options.name, "takes neither --scene nor --mesh");
  int status = done;
  try {
    chosen->run({options.output, options.tets, options.quick, options.threads, options.minutes,
                 options.scenes, options.meshes});
  } catch (const bench::WrongResult& wrong) {
    print_errors(wrong.what());
    status = ended_early;
  }
  if (!std::filesystem::exists(options.output / (options.name + ".gp"))) return status;
  plot(options.output, options.name);
  std::printf("written to %s\n", options.output.c_str());
  return status;
}

}  // namespace lobe::program
