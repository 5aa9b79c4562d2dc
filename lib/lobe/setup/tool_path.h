// Paths of tools, and what the setups of all tools check.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct PathPoint {
  double time = 0;                 // [s]
  Vec3d position = Vec3d::Zero();  // [m]; for a grasp the offset from where it took hold
  // For a grasp its turn since it took hold, about its centre there; a unit quaternion x, y, z, w.
  Eigen::Vector4d orientation{0, 0, 0, 1};
  double opening = 0;  // distance of jaws [m]
  static constexpr auto fields =
      std::tuple(&PathPoint::time, &PathPoint::position, &PathPoint::orientation, &PathPoint::opening);
};
// Whether times increase, values are finite and quaternions have length 1.
bool is_path(const std::vector<PathPoint>& path);

// cautery "hook": the tool in messages.
template <class ToolSetup>
std::string type_and_name(const ToolSetup& tool) {
  return std::string(ToolSetup::type) + " \"" + tool.name + "\"";
}

template <class ToolSetup>
void check_path(const ToolSetup& tool, const Expect& expect) {
  expect(!tool.path.empty(), type_and_name(tool) + " has no path");
  expect(is_path(tool.path),
         type_and_name(tool) +
             ": the times of its path must increase, all its values be finite, quaternions of length 1");
}

}  // namespace lobe
