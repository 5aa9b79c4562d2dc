#include <Eigen/Geometry>
#include <algorithm>

#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

// Does the segment from a to b meet the box? Slabs: the parameters s at which a + s(b − a) is inside each.
bool meets_box(const Vec3d& a, const Vec3d& b, const Vec3d& low, const Vec3d& high) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double step = b[i] - a[i];
    if (step == 0) {
      if (a[i] < low[i] || a[i] > high[i]) return false;
      continue;
    }
    const double s = (low[i] - a[i]) / step, t = (high[i] - a[i]) / step;
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  return enter <= leave;
}

// How far the body may move from its box at rest: gravity, loads or other tools may carry it as far as it is
// long.
double reach_of(const Scene& scene, const TetMesh& mesh) {
  const auto moves = [](const Boundary& entry) {
    return entry.value != Vec3d::Zero() || entry.pressure != 0;
  };
  const bool is_moved = scene.gravity != Vec3d::Zero() || scene.tools.size() > 1 ||
                        std::any_of(scene.boundary.begin(), scene.boundary.end(), moves);
  const Box box = bounding_box(mesh);
  return is_moved ? (box.max - box.min).norm() : 0;
}

bool passes_near(const Tool& tool, const TetMesh& mesh, double reach) {
  const Box box = bounding_box(mesh);
  const double margin = tool.radius + tool.hook.norm() + reach;
  const Vec3d low = box.min.array() - margin, high = box.max.array() + margin;
  for (std::size_t i = 0; i < tool.path.size(); ++i) {
    const std::size_t next = std::min(i + 1, tool.path.size() - 1);
    if (meets_box(tool.path[i].position, tool.path[next].position, low, high)) return true;
  }
  return false;
}

void check_core(Resolution& resolution, const Tool& tool, const std::string& here) {
  if (!(tool.core < tool.radius))
    resolution.fail(here + "/core", rounded(tool.core) + " m, must be below the radius, " +
                                        rounded(tool.radius) + " m: what it touches is to burn");
}

void resolve_cautery(Resolution& resolution, const Tool& tool, const std::string& here) {
  check_core(resolution, tool, here);
  resolution.result.setup.cauteries.push_back({tool.name, tool.radius, tool.path, tool.hook, tool.core});
  if (!passes_near(tool, resolution.mesh(), reach_of(resolution.scene, resolution.mesh())))
    resolution.warn(here + "/path", "never comes within its radius of the mesh's bounding box");
}

BringTool bring_cautery(Resolution& resolution, const Tool& tool, const std::string& here) {
  check_core(resolution, tool, here);
  const PathPoint& at = tool.path.front();
  return BringCautery{tool.name, tool.radius, at.position, Eigen::Quaterniond(at.orientation) * tool.hook,
                      tool.core};
}

void summarise_cautery(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry) {
  const CauterySetup& cautery = setup.cauteries[number];
  entry["radius_m"] = cautery.radius;
  if (cautery.hook != Vec3d::Zero()) entry["hook_m"] = cautery.hook.norm();
}

void append_cauteries(const ToolSetups& done, Index, std::vector<Tool>& tools) {
  for (const CauterySetup& cautery : done.cauteries) {
    Tool& tool = tools.emplace_back();
    tool.name = cautery.name;
    tool.type = CauterySetup::type;
    tool.radius = cautery.radius;
    tool.hook = cautery.hook;
    tool.core = cautery.core;
    tool.path = cautery.path;
  }
}

}  // namespace

extern const ToolKind cautery_kind;
const ToolKind cautery_kind{CauterySetup::type,
                            "4 numbers, time and place of the tip, or 8 with a quaternion",
                            read_keys_of<keys::cautery_keys>,
                            write_keys_of<keys::cautery_keys>,
                            read_turning_row,
                            write_turning_row,
                            resolve_cautery,
                            bring_cautery,
                            summarise_cautery,
                            append_cauteries};

}  // namespace lobe
