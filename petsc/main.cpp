// lobe-petsc, which `lobe solve --solver petsc` starts, under `mpirun -n N` or alone.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <exception>

#include "console.h"
#include "lobe_petsc/solve_scene.h"

namespace {

using namespace lobe::program;
using lobe::petsc::Ranks;

void add_options(CLI::App& app, lobe::petsc::SceneOptions& options, std::string& solver) {
  app.add_option("SCENE", options.scene, "scene file (docs/scene.md)")->required();
  app.add_option("--mesh", options.mesh, "mesh to use in place of the scene's");
  app.add_option("-o,--output", options.output, "directory for the results")->required();
  app.add_option("--method", options.method, "auto, gamg, hypre or mumps (docs/huge.md)")
      ->capture_default_str();
  app.add_option("--tolerance", options.tolerance, "of the residual, relative to loads and reactions")
      ->check(CLI::Range(1e-14, 1e-2))
      ->capture_default_str();
  app.add_flag("--json", options.json, "print the report alone");
  app.add_flag("--verbose", options.verbose, "a line for each of Newton's iterations");
  app.add_option("--solver", solver, "petsc")->check(CLI::IsMember({"petsc"}));
}

// An error of all ranks is printed once. An error of a single rank ends the others too, because they wait for
// that rank.
int solve(const Ranks& ranks, int argc, char** argv) {
  CLI::App app{"Static equilibrium of a scene in parts", "lobe-petsc"};
  lobe::petsc::SceneOptions options;
  std::string solver;
  add_options(app, options, solver);
  const bool talks = ranks.rank() == 0;
  try {
    app.parse(argc, argv);
    return lobe::petsc::solve_scene(ranks, options) ? done : ended_early;
  } catch (const CLI::Success& help) {
    return talks ? app.exit(help) : done;
  } catch (const CLI::Error& error) {
    if (talks) print_errors(error.what());
  } catch (const lobe::InputError& error) {
    if (talks) print_errors(error.what());
  } catch (const std::exception& error) {
    print_errors("rank " + std::to_string(ranks.rank()) + ": " + error.what());
    MPI_Abort(ranks.comm(), bad_input);
  }
  return bad_input;
}

}  // namespace

int main(int argc, char** argv) {
  const bool named = argc > 1 && std::strcmp(argv[1], "solve") == 0;  // as `lobe` forwards it
  try {
    const lobe::petsc::Library library(1, argv);
    return solve(Ranks(PETSC_COMM_WORLD), argc - named, argv + named);
  } catch (const std::exception& error) {
    print_errors(error.what());
    return bad_input;
  }
}
