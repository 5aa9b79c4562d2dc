// lobe-bench, which `lobe bench` starts: docs/benchmarks.md and docs/validation.md say how to read what it
// writes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>

#include "benchmarks/benchmarks.h"
#include "console.h"
#include "lobe/error.h"

namespace {

using namespace lobe::program;
using lobe::bench::Benchmark;

struct Arguments {
  std::string name;
  lobe::bench::Options options;
};

void add_options(CLI::App& app, Arguments& arguments) {
  lobe::bench::Options& options = arguments.options;
  app.add_option("NAME", arguments.name,
                 "which benchmark: kernels, cut, realtime, features, elements, hybrid, accuracy, validation, "
                 "surface, "
                 "skin, scalpel, contact, palpation, live, haptic, huge, steps, own_steps, own_pairs, "
                 "stress or soak")
      ->required();
  app.add_option("-o,--output", options.output, "directory for the table and the plot")->required();
  app.add_option("--tets", options.tets, "numbers of tetrahedra, N[,N...]")
      ->delimiter(',')
      ->check(CLI::Range(6, 5000000));
  app.add_flag("--quick", options.quick, "less precise, or with smaller meshes");
  app.add_option("--threads", options.threads,
                 "kernels, realtime: timed as well as one thread; accuracy: of every run; huge: most ranks")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  auto* loop = app.add_flag("--loop", options.loop, "haptic: only how punctual the loop is");
  app.add_flag("--predictions", options.predictions, "haptic: only what is felt between frames")
      ->excludes(loop);
  app.add_flag("--single", options.single, "accuracy: only in single precision");
  app.add_flag("--reduced", options.reduced,
               "hybrid: only gestures, all non-linear and all reduced, and natural frequencies");
  app.add_option("--model", options.model, "stress: only this model");
  app.add_option("--family", options.family, "validation: only this family of cases");
  app.add_option("--frames", options.frames, "soak: of each session")->check(CLI::Range(10, 100'000'000));
  app.add_option("--minutes", options.minutes, "soak: how long; live: simulated minutes of random hands")
      ->check(CLI::Range(0.01, 1e5))
      ->capture_default_str();
  app.add_option("--scene", options.scenes,
                 "accuracy, hybrid, realtime: your own scene, in place of the shipped ones")
      ->allow_extra_args(false);
  app.add_option("--mesh", options.meshes,
                 "accuracy, hybrid, realtime: a further mesh of that scene; scalpel: a further organ; "
                 "elements, haptic: a further liver")
      ->allow_extra_args(false);
  app.add_option("--refine", options.refine,
                 "accuracy: total errors are against this mesh of the scene, refined once, in place of the "
                 "largest");
}

const Benchmark& benchmark_of(const Arguments& arguments) {
  const auto benchmarks = lobe::bench::all_benchmarks();
  const auto chosen = std::find_if(benchmarks.begin(), benchmarks.end(),
                                   [&](const Benchmark& b) { return arguments.name == b.name; });
  if (chosen == benchmarks.end()) {
    std::string message = "no such benchmark; there are:";
    for (const Benchmark& b : benchmarks) message += std::string("\n  ") + b.name + ": " + b.help;
    throw lobe::InputError("bench " + arguments.name, message);
  }
  if (!chosen->takes_scenes && !arguments.options.scenes.empty())
    throw lobe::InputError("bench " + arguments.name, "takes no --scene");
  if (!chosen->takes_meshes && !arguments.options.meshes.empty())
    throw lobe::InputError("bench " + arguments.name, "takes no --mesh");
  if (arguments.name != "accuracy" && !arguments.options.refine.empty())
    throw lobe::InputError("bench " + arguments.name, "takes no --refine");
  return *chosen;
}

// DIR/NAME.png by DIR/NAME.gp, if gnuplot is installed.
void plot(const std::filesystem::path& directory, const std::string& name) {
  std::string quoted;
  for (char c : directory.string()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  const int status = run_program({"gnuplot", "-e", "cd '" + quoted + "'", name + ".gp"});
  if (status == 127) print_warnings({"gnuplot is not installed: no " + name + ".png"});
  if (status != 0 && status != 127) print_warnings({"gnuplot failed: no " + name + ".png"});
}

int run_benchmark(const Arguments& arguments) {
  const Benchmark& benchmark = benchmark_of(arguments);
  int status = done;
  try {
    benchmark.run(arguments.options);
  } catch (const lobe::bench::WrongResult& wrong) {
    print_errors(wrong.what());
    status = ended_early;
  }
  if (!std::filesystem::exists(arguments.options.output / (arguments.name + ".gp"))) return status;
  plot(arguments.options.output, arguments.name);
  std::printf("written to %s\n", arguments.options.output.c_str());
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measure speed, accuracy (docs/benchmarks.md), correctness (docs/validation.md)",
               "lobe bench"};
  Arguments arguments;
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
    return run_benchmark(arguments);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {
    print_errors(error.what());
  }
  return bad_input;
}
