// Divides a triangle of a skin along the lines in which a body has come apart under it.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// A point on the rim of a triangle: a corner, or a place where a line crosses a side.
struct RimPoint {
  int side = 0;                   // from this corner to the next
  double share = 0;               // of the side; 0: the corner
  Index before = -1, after = -1;  // what lies under the rim before and behind it; the same at a corner
};

struct TrianglePart {
  std::array<int, 3> points;      // of the rim, in its turn
  std::array<Index, 3> elements;  // that carry them
};

// The lines cut the rim into arcs. Each part of the triangle lies on one arc. Its points are carried by what
// lies under that arc, at its ends. What is left between three or more lines goes to the arc that lies on the
// same as its middle. A line that crosses only one side leads to the opposite corner. If there are several
// such lines, what is between them stays with the rest. Parts fill the triangle exactly. `rim`: points in
// order around the triangle from corner 0 on, at least one of which is no corner. `middle`: what lies under
// the middle of the points that are no corners. `on_one_side`: whether two things under the skin are
// connected.
std::vector<TrianglePart> divide_triangle(const std::vector<RimPoint>& rim, Index middle,
                                          const std::function<bool(Index, Index)>& on_one_side);

}  // namespace lobe
