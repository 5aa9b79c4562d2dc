#include "lobe/sim/tools.h"

#include <algorithm>
#include <limits>

namespace lobe {

double Tools::next_grasp_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const GraspSetup& grasp : grasps_) {
    if (grasp.path.front().time > time) next = std::min(next, grasp.path.front().time);
    if (grasp.release && grasp.path.back().time > time) next = std::min(next, grasp.path.back().time);
  }
  return next;
}

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
