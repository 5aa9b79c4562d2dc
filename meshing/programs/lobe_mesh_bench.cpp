// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// lobe-mesh-bench quality|fuzz SURFACE… -o DIR. Exit status: 0 all as it must be, 1 not all, 2 bad input.
#include <CLI/CLI.hpp>
#include <iostream>

#include "bench.h"
#include "lobe/error.h"

int main(int argc, char** argv) {
  using namespace lobe::meshing;
  CLI::App app("What lobe-mesh reaches, and what it survives.", "lobe-mesh-bench");
  BenchOptions options;
  const auto common = [&](CLI::App& command) {
    command
        .add_option("SURFACE", options.surfaces, "surfaces, and for quality label images, as for lobe-mesh")
        ->required();
    command.add_option("-o,--output", options.output, "folder for the table, made if missing")->required();
  };
  CLI::App& quality = *app.add_subcommand("quality", "quality, time and memory of meshes of several sizes");
  CLI::App& fuzz = *app.add_subcommand("fuzz", "surfaces damaged at random");
  common(quality);
  common(fuzz);
  const auto sizes = [&](const char* name, std::vector<int>& tets, const char* help) {
    quality.add_option(name, tets, help)->delimiter(',')->allow_extra_args(false)->capture_default_str();
  };
  sizes("--tets", options.tets, "numbers of tetrahedra");
  sizes("--first-tets", options.first_tets, "more of them for the first surface");
  fuzz.add_option("--first", options.first, "number of the first damaged surface")->capture_default_str();
  fuzz.add_option("--count", options.count, "of damaged surfaces")->capture_default_str();
  fuzz.add_option("--time-limit", options.time_limit, "of each [s]")->capture_default_str();
  fuzz.add_option("--repair", options.repair, "of each: basic or wrap")->capture_default_str();
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
    std::filesystem::create_directories(options.output);
    return (quality.parsed() ? bench_quality(options) : bench_fuzz(options)) == 0 ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "lobe-mesh-bench: error: " << error.what() << "\n";
    return 2;
  }
}
