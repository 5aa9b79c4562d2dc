#include <algorithm>

#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

void check_gap(Resolution& resolution, const Tool& tool, const std::string& here) {
  if (!(tool.clip.gap < tool.clip.opening))
    resolution.fail(here + "/gap", rounded(tool.clip.gap) + " m, must be below the opening, " +
                                       rounded(tool.clip.opening) + " m");
}

void resolve_clip_applier(Resolution& resolution, const Tool& tool, const std::string& here) {
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
  resolution.result.setup.clip_appliers.push_back({tool.name, tool.clip, tool.path});
}

BringTool bring_clip_applier(Resolution& resolution, const Tool& tool, const std::string& here) {
  check_gap(resolution, tool, here);
  return BringClipApplier{tool.name, tool.clip, tool.path.front().position, tool.path.front().orientation};
}

void summarise_clip_applier(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry) {
  const ClipApplierSetup& applier = setup.clip_appliers[number];
  entry["clips"] = applier.path.size();
  entry["length_m"] = applier.clip.length;
  entry["opening_m"] = applier.clip.opening;
  entry["gap_m"] = applier.clip.gap;
}

void append_clip_appliers(const ToolSetups& done, Index, std::vector<Tool>& tools) {
  for (const ClipApplierSetup& applier : done.clip_appliers) {
    Tool& tool = tools.emplace_back();
    tool.name = applier.name;
    tool.type = ClipApplierSetup::type;
    tool.clip = applier.clip;
    tool.path = applier.path;
  }
}

}  // namespace

extern const ToolKind clip_applier_kind;
const ToolKind clip_applier_kind{ClipApplierSetup::type,
                                 "4 numbers, time and place of a clip, or 8 with a quaternion",
                                 read_keys_of<keys::clip_applier_keys>,
                                 write_keys_of<keys::clip_applier_keys>,
                                 read_turning_row,
                                 write_turning_row,
                                 resolve_clip_applier,
                                 bring_clip_applier,
                                 summarise_clip_applier,
                                 append_clip_appliers};

}  // namespace lobe
