#include "lobe/sim/tools.h"

#include <algorithm>

namespace lobe {

std::vector<Sweep> Tools::sweeps(double from, double to) const {
  std::vector<Sweep> sweeps;
  for (const CauterySetup& c : cauteries_) {
    const double begin = std::max(from, c.path.front().time), end = std::min(to, c.path.back().time);
    if (begin > end) continue;
    Vec3d tip = path_at(c.path, begin);
    for (const PathPoint& point : c.path) {
      if (point.time <= begin || point.time >= end) continue;
      sweeps.push_back({tip, point.position, c.radius});
      tip = point.position;
    }
    sweeps.push_back({tip, path_at(c.path, end), c.radius});
  }
  return sweeps;
}

}  // namespace lobe
