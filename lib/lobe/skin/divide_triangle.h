// Divides a triangle of a skin along the lines in which a body has come apart under it.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// A point on the rim of a triangle: a corner, or a place where a line crosses a side.
struct RimPoint {
  int side = 0;                   // corner from which the side leads to the next one
  double share = 0;               // place as a share of the side; 0: the corner
  Index before = -1, after = -1;  // elements under the rim before and behind it; the same at a corner
};

struct TrianglePart {
  std::array<int, 3> points;      // points of the rim, in its turn
  std::array<Index, 3> elements;  // elements that carry them
};

// Returns the parts, which fill the triangle exactly. The lines cut the rim into arcs, and each part lies on
// one arc. The elements under that arc carry its points. Three or more lines leave a polygon between them. It
// goes to an arc whose element is connected to `middle`. If all lines cross the same side, each leads to the
// opposite corner, and what lies between two of them stays with the rest of the triangle.
// `rim`: points in order from corner 0, at least one of which is no corner. `middle`: the element under the
// mean of the points that are no corners. `on_one_side`: whether two elements are connected.
std::vector<TrianglePart> divide_triangle(const std::vector<RimPoint>& rim, Index middle,
                                          const std::function<bool(Index, Index)>& on_one_side);

}  // namespace lobe
