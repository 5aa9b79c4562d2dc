// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What the command line of lobe-mesh says.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "lobe_mesh/repair.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

struct Options {
  std::vector<std::string> surfaces;  // those that bound cavities last, once the options are checked
  std::vector<std::string> voids;     // files of the surfaces that bound cavities
  std::string output, repaired, report, marked, picture;
  std::vector<std::string> label_edges, balls, sizes;
  double scale = 1;
  bool has_scale = false;    // whether it was asked for
  bool find_units = false;   // whether the scale is 0.001 for a body that is larger than an organ in metres
  double voxels = 0;         // [m] edge of those that surfaces are turned into, 0: none
  bool find_voxels = false;  // whether surfaces that cannot be meshed as they are become voxels
  bool diagnose = false, measure = false, json = false, quiet = false;
  RepairOptions repair;
  MeshOptions mesh;

  bool is_image() const { return is_label_image(surfaces.front()); }
  std::vector<std::string> outputs() const { return {output, repaired, report, marked, picture}; }
};

void declare_options(CLI::App& app, Options& options);

// After parsing: throws InputError with all faults at once.
void check_options(const CLI::App& app, Options& options);

}  // namespace lobe::meshing
