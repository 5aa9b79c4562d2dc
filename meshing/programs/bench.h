// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What lobe-mesh-bench runs: each calls lobe-mesh as a user would, prints a table and writes DIR/NAME.csv
// and DIR/NAME.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lobe::meshing {

struct BenchOptions {
  std::vector<std::string> surfaces;
  std::filesystem::path output;
  std::vector<int> tets = {2000, 20000, 200000};
  std::vector<int> first_tets;   // tetrahedra of the first surface, beside those
  int first = 0;                 // number of the first fuzzed surface
  int count = 1000;              // number of fuzzed surfaces
  double time_limit = 60;        // [s] of each of those
  std::string repair = "basic";  // repair of those, as for lobe-mesh
};

// Every surface with both meshers at every size: time step, angles, volume, processor time, memory. Returns
// how many meshes are below the gate or have more than 1 % of volume error from 20,000 tetrahedra on.
int bench_quality(const BenchOptions& options);

// Surfaces damaged at random: each must end in a valid mesh or in a named error. Returns how many did not.
int bench_fuzz(const BenchOptions& options);

}  // namespace lobe::meshing
