#include "lobe/setup/tool_path.h"

#include <cmath>

namespace lobe {

bool is_path(const std::vector<PathPoint>& path) {
  for (std::size_t i = 0; i < path.size(); ++i)
    if (!std::isfinite(path[i].time) || !path[i].position.allFinite() || !std::isfinite(path[i].opening) ||
        path[i].opening < 0 || !(std::abs(path[i].orientation.norm() - 1) < 1e-6) ||
        (i > 0 && !(path[i].time > path[i - 1].time)))
      return false;
  return true;
}

}  // namespace lobe
