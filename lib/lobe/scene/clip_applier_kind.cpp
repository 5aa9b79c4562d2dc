#include "lobe/scene/clip_applier_kind.h"

namespace lobe {
namespace {

void check_gap(Resolution& resolution, const ClipApplierSetup& tool, const std::string& here) {
  if (!(tool.clip.gap < tool.clip.opening))
    resolution.fail(here + "/gap", rounded(tool.clip.gap) + " m, must be below the opening, " +
                                       rounded(tool.clip.opening) + " m");
}

}  // namespace

void KindOf<ClipApplierSetup>::resolve(Resolution& resolution, ClipApplierSetup& tool,
                                       const std::string& here) {
  check_gap(resolution, tool, here);
  const Box box = bounding_box(resolution.mesh());
  const double reach = (Vec3d(tool.clip.length, tool.clip.width, tool.clip.opening) / 2).norm();
  for (std::size_t i = 0; i < tool.path.size(); ++i) {
    const Vec3d& at = tool.path[i].position;
    if ((at - at.cwiseMax(box.min).cwiseMin(box.max)).norm() > reach)
      resolution.warn(here + "/path/" + std::to_string(i),
                      "the clip closes outside of the mesh's bounding box: on nothing, unless tissue is "
                      "moved there before");
  }
}

BringTool KindOf<ClipApplierSetup>::bring(Resolution& resolution, const ClipApplierSetup& tool,
                                          const std::string& here) {
  check_gap(resolution, tool, here);
  return BringClipApplier{tool.name, tool.clip, tool.path.front().position, tool.path.front().orientation};
}

void KindOf<ClipApplierSetup>::summarise(const ClipApplierSetup& setup, nlohmann::ordered_json& entry) {
  entry["clips"] = setup.path.size();
  entry["length_m"] = setup.clip.length;
  entry["opening_m"] = setup.clip.opening;
  entry["gap_m"] = setup.clip.gap;
}

std::string KindOf<ClipApplierSetup>::describe(const nlohmann::ordered_json& entry) {
  return counted(entry["clips"].get<std::size_t>(), "clip", "clips") + " of " + rounded(entry["length_m"]) +
         " m, from " + rounded(entry["opening_m"]) + " to " + rounded(entry["gap_m"]) + " m";
}

}  // namespace lobe
