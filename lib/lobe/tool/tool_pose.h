// Poses of tools: where they are, and where they go.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lobe/cut/tet_groups.h"
#include "lobe/scalpel/blades.h"
#include "lobe/scalpel/cut_work.h"
#include "lobe/setup/clip_setup.h"
#include "lobe/setup/exclusions.h"
#include "lobe/tool/paths.h"

namespace lobe {

using ToolId = int;  // number above 0; for a grasp also the holder of its vertices (HeldVertices::Held)

struct ToolPose {
  Vec3d position = Vec3d::Zero();           // [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w; where it took hold: none
  std::optional<double> opening = {};       // distance of jaws [m]; none: as it is

  bool operator==(const ToolPose&) const = default;
  static constexpr auto fields = std::tuple(&ToolPose::position, &ToolPose::orientation, &ToolPose::opening);
};

// The shape by which a tool is drawn.
struct ToolShape {
  // Radius of a sphere, a capsule or a cautery's tip; half the width of jaws; half the least extent of a box
  // or mesh [m].
  double radius = 0;
  // From the tool's position: to the heel of a scalpel, or along the axis of a capsule or of jaws [m].
  Vec3d blade = Vec3d::Zero();
  double opening = 0;         // distance of jaws [m]
  Vec3d jaw = Vec3d::Zero();  // width, thickness and length of each jaw [m]; 0: it has none
};

// Where a tool is, for pictures and recordings.
struct PlacedTool {
  std::string name;
  const char* type = "";           // type in a scene
  Vec3d position = Vec3d::Zero();  // [m]
  ToolShape shape = {};
  std::vector<Index> vertices = {};                     // held vertices
  Eigen::Vector4d orientation{0, 0, 0, 1};              // unit quaternion x, y, z, w
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();  // means over the last frame, on the body [N], [N m]
};

// The vertices that a tool holds, and where they are [m].
using HeldPoints = std::function<std::vector<std::pair<Index, Vec3d>>(ToolId)>;

// A clip that closes at a place [m].
struct ClipClosure {
  ToolId tool = 0;
  int number = 0;  // number among the clips of the tool
  std::string name;
  ClipShape shape;
  Vec3d position;               // place of its middle [m]
  Eigen::Vector4d orientation;  // unit quaternion x, y, z, w
};

// What tools do to the body between two times.
struct ToolWork {
  std::vector<ClipClosure> clips;
  std::vector<SweptVolume> burnt;  // volumes: the tetrahedra that meet them are removed
  std::vector<BladeMove> cuts;
};

}  // namespace lobe
