// Tools that a hand brings, in the JSON of scenes: what a scene says of a tool, with "at" in place of "path".
//   {"type": "probe", "shape": {"sphere": {"radius": 0.01}}, "at": [0.1, 0, 0.05]}
// "at" is a row of its path without the time (docs/scene.md).
#pragma once

#include <filesystem>
#include <string_view>

#include "lobe/tool/tool_lists.h"

namespace lobe {

struct ParsedTool {
  BringTool command;
  Vec3d position = Vec3d::Zero();  // place of its centre, or tip [m]
};

// Throws InputError with every fault, each with its JSON pointer: "/shape/sphere/radius: 0, must be above 0".
// A grasp is no such tool: a hand takes hold of vertices. Relative paths of shapes are relative to `folder`.
ParsedTool parse_tool(std::string_view text, const std::filesystem::path& folder = ".");

}  // namespace lobe
