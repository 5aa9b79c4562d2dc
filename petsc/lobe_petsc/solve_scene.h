// `lobe solve SCENE --solver petsc`: from the files to a solution in parts.
#pragma once

#include <filesystem>

#include "lobe_petsc/static_solver.h"

namespace lobe::petsc {

struct SceneOptions {
  std::filesystem::path scene, mesh, output;  // mesh: in place of the scene's, if not empty
  std::string method = "auto";
  double tolerance = 1e-10;
  bool json = false;
  bool verbose = false;  // a line per Newton iteration
};

// Writes DIR/solution.pvtu with one solution_RANK.vtu per rank (displacement, vertex: its number in the mesh;
// region, volume_ratio, von_mises [Pa], source: the tetrahedron's number, rank) and DIR/report.json. The
// index is written last. Rank 0 prints. Throws InputError on all ranks for bad input. Returns whether it
// converged.
bool solve_scene(const Ranks& ranks, const SceneOptions& options);

}  // namespace lobe::petsc
