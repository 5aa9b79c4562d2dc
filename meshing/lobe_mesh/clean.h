// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Index work on triangle soups that needs no geometry library.
#pragma once

#include <vector>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// Finite, and not so large (1e50) that its cube overflows.
bool usable(const Vec3d& point);

// Whether a triangle has no area, but for rounding: then it has no normal, either.
bool degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c);

// For every point the first one with the same coordinates (itself, if there is none).
std::vector<Index> first_of_equal_points(const Mat3X<double>& points);

struct CleanReport {
  Index welded = 0;      // points that equal an earlier one
  Index repeated = 0;    // triangles that use a point twice
  Index duplicates = 0;  // triangles with the same three points as an earlier one
  Index unused = 0;      // points without a triangle, before the clean-up
};

// Welds equal points, drops triangles that use a point twice or repeat an earlier one, and unused points.
Surface clean(const Surface& surface, CleanReport& report);

// Welds points on open edges that are nearer than `tolerance` to each other; returns how many.
Index weld_open_edges(Surface& surface, double tolerance);

}  // namespace lobe::meshing
