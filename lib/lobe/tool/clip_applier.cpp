#include "lobe/tool/clip_applier.h"

#include <cmath>
#include <utility>

#include "lobe/error.h"

namespace lobe {

void BringClipApplier::check(Index, const Options& used) const {
  refuse_excluded(Option::force_terms, used, "clip applier");
  if (const std::string fault = clip.fault(); !fault.empty()) throw InputError("clip applier", fault);
  if (!position.allFinite() || !(std::abs(orientation.norm() - 1) < 1e-6))
    throw InputError("clip applier", "needs a finite position and a unit quaternion for its orientation");
}

void ClipApplier::turn_on(bool on) {
  if (on && !is_shut) is_closing = true;
  is_shut = on;
}

ToolShape ClipApplier::shape() const {
  return {.radius = clip.width / 2,
          .blade = Eigen::Quaterniond(pose.orientation) * Vec3d(clip.length, 0, 0),
          .opening = is_shut ? clip.gap : clip.opening,
          .jaw = {clip.width, clip.width, clip.length}};
}

// A frame that failed begins again at the same time: what closed then has closed.
void ClipApplier::begin_frame(double time, double) {
  if (!is_live) return;
  if (std::exchange(is_closing, false) && (closed.empty() || closed.back().time < time - just_before))
    closed.push_back({time, pose.position, pose.orientation});
  if (const auto to = std::exchange(target, std::nullopt)) pose = *to;
}

std::vector<ClipApplierSetup> ClipApplier::paths() const {
  if (closed.empty()) return {};
  return {{name, clip, closed.all()}};
}

void ClipApplier::add_work(double from, double to, ToolWork& work) const {
  const std::vector<PathPoint>& rows = closed.recent();
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].time >= from - just_before && rows[i].time < to - just_before)
      work.clips.push_back(
          {id, int(closed.size() - rows.size() + i), name, clip, rows[i].position, rows[i].orientation});
}

std::optional<PlacedTool> ClipApplier::placed(double time, const HeldPoints&) const {
  if (is_live ? is_away : !acts_at(time, closed.recent())) return std::nullopt;
  const ToolPose now =
      is_live ? pose : ToolPose{path_at(closed.recent(), time), orientation_at(closed.recent(), time)};
  PlacedTool tool{.name = name,
                  .type = Path::type,
                  .position = now.position,
                  .shape = shape(),
                  .orientation = now.orientation};
  tool.shape.blade = Eigen::Quaterniond(now.orientation) * Vec3d(clip.length, 0, 0);
  return tool;
}

bool ClipApplier::fits(Index) const {
  return clip.fault().empty() && pose.position.allFinite() && is_path(closed.all());
}

}  // namespace lobe
