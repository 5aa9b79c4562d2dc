#include "lobe/scene/cautery_kind.h"

#include <Eigen/Geometry>
#include <algorithm>

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

bool passes_near(const CauterySetup& tool, const TetMesh& mesh, double reach) {
  const Box box = bounding_box(mesh);
  const double margin = tool.radius + tool.hook.norm() + reach;
  const Vec3d low = box.min.array() - margin, high = box.max.array() + margin;
  for (std::size_t i = 0; i < tool.path.size(); ++i) {
    const std::size_t next = std::min(i + 1, tool.path.size() - 1);
    if (meets_box(tool.path[i].position, tool.path[next].position, low, high)) return true;
  }
  return false;
}

void check_core(Resolution& resolution, const CauterySetup& tool, const std::string& here) {
  if (!(tool.core < tool.radius))
    resolution.fail(here + "/core", rounded(tool.core) + " m, must be below the radius, " +
                                        rounded(tool.radius) + " m: what it touches is to burn");
}

}  // namespace

void KindOf<CauterySetup>::resolve(Resolution& resolution, CauterySetup& tool, const std::string& here) {
  check_core(resolution, tool, here);
  if (!passes_near(tool, resolution.mesh(), reach_of(resolution.scene, resolution.mesh())))
    resolution.warn(here + "/path", "never comes within its radius of the mesh's bounding box");
}

BringTool KindOf<CauterySetup>::bring(Resolution& resolution, const CauterySetup& tool,
                                      const std::string& here) {
  check_core(resolution, tool, here);
  const PathPoint& at = tool.path.front();
  return BringCautery{tool.name, tool.radius, at.position, Eigen::Quaterniond(at.orientation) * tool.hook,
                      tool.core};
}

void KindOf<CauterySetup>::summarise(const CauterySetup& setup, nlohmann::ordered_json& entry) {
  entry["radius_m"] = setup.radius;
  if (setup.hook != Vec3d::Zero()) entry["hook_m"] = setup.hook.norm();
}

std::string KindOf<CauterySetup>::describe(const nlohmann::ordered_json& entry) {
  const std::string tip = "radius " + rounded(entry["radius_m"]) + " m";
  return entry.contains("hook_m") ? tip + ", a hook of " + rounded(entry["hook_m"]) + " m" : tip;
}

}  // namespace lobe
