// Paths of tools in time. The path of a tool that is led by hand grows by a row per frame. Saved as the path
// of a scene, it gives the same bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lobe/setup/boundary_conditions.h"

namespace lobe {

// Times are sums of steps: two times that differ by less count as equal [s].
inline constexpr double just_before = 1e-9;

// The first row after a time.
inline auto after(const std::vector<PathPoint>& path, double time) {
  return std::upper_bound(path.begin(), path.end(), time,
                          [](double t, const PathPoint& point) { return t < point.time; });
}

inline bool acts_at(double time, const std::vector<PathPoint>& path) {
  return !path.empty() && time >= path.front().time && time <= path.back().time;
}

// The time just after the frame's start. A stroke that began at the start itself would, as a path of a scene,
// begin in the frame before.
inline double start_of_stroke(double time) {
  return std::nextafter(time, std::numeric_limits<double>::infinity());
}

}  // namespace lobe
