// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Makes a surface closed, manifold, free of self-intersections and facing outwards.
#pragma once

#include <string>
#include <vector>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

enum class Repair {
  none,            // check only: anything that cannot be meshed is refused
  basic,           // weld, orient, stitch, drop specks, fill small holes, undo self-intersections
  wrap_if_needed,  // basic, and where that does not succeed wrap
  wrap,            // a new surface around the old one: always closed, but larger; the last resort
};

struct RepairOptions {
  Repair level = Repair::basic;
  double largest_hole = 0.15;  // share of the surface's diagonal: wider holes are refused, not filled
  double wrap_alpha = 0;       // [m] gaps narrower than this are bridged; 0: diagonal / 60
  double wrap_offset = 0;      // [m] distance of the wrapping from the surface; 0: alpha / 30
};

// What one step of the repair did. Steps that changed nothing are not listed.
struct RepairStep {
  std::string name;
  Index count = 0;      // number of changes
  std::string message;  // "filled 2 holes with 17 triangles"
  // [m³] enclosed before and after the step. Means little while the surface is open.
  double volume_before = 0, volume_after = 0;
  double distance = 0;  // [m] of the surface after the step from the input, sampled as max_distance is

  std::string in_words() const;
};

struct RepairReport {
  std::vector<RepairStep> steps;
  std::vector<std::string> warnings;
  double volume_before = 0;  // [m³] enclosed by the input; of little meaning if that is open
  double volume_after = 0;   // [m³]
  double max_distance = 0;  // [m] from vertices and centres of triangles of input and result to the other one
  int pieces = 0;           // bodies (outer shells) in the result
  int cavities = 0;         // inner shells
};

// Throws InputError, with the option that would help, if the surface is beyond the chosen level.
Surface repair_surface(const Surface& surface, const RepairOptions& options, RepairReport& report);

}  // namespace lobe::meshing
