#include "lobe/tool/cautery.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/error.h"

namespace lobe {

void BringCautery::check(Index, const Options&) const {
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError("cautery", "needs a radius above 0 m, and finite");
  if (!position.allFinite()) throw InputError("cautery", "needs a finite position");
  if (!hook.allFinite()) throw InputError("cautery", "needs a finite hook");
}

void Cautery::turn_on(bool on) {
  if (on && !burns) {
    settle();
    strokes.emplace_back();
  }
  burns = on;
}

bool Cautery::has_ended(double time) const {
  return is_away && (strokes.empty() || strokes.back().empty() || strokes.back().back().time < time);
}

void Cautery::settle() {
  if (!strokes.empty()) strokes.back().settle();
}

void Cautery::begin_frame(double time, double end) {
  if (!is_live) return;
  const ToolPose from = pose;
  if (const auto to = std::exchange(target, std::nullopt)) pose = *to;
  if (!burns) return;
  GrowingPath& stroke = strokes.back();
  stroke.forget_after(time);
  if (stroke.empty()) stroke.push_back({start_of_stroke(time), from.position, from.orientation});
  stroke.push_back({end, pose.position, pose.orientation});
}

std::vector<CauterySetup> Cautery::paths() const {
  std::vector<CauterySetup> paths;
  for (const GrowingPath& stroke : strokes)
    if (!stroke.empty()) paths.push_back({name, radius, stroke.all(), hook});
  return paths;
}

Vec3d Cautery::wire_at(const Eigen::Vector4d& orientation) const {
  return Eigen::Quaterniond(orientation) * hook;
}

void Cautery::add_work(double from, double to, ToolWork& work) const {
  for (const GrowingPath& stroke : strokes) {
    if (stroke.empty() || stroke.back().time < from) continue;
    const std::vector<PathPoint>& path = stroke.recent();
    const double begin = std::max(from, path.front().time), end = std::min(to, path.back().time);
    if (begin > end) continue;
    auto sweep_to = [&, tip = path_at(path, begin),
                     wire = wire_at(orientation_at(path, begin))](double time) mutable {
      const Vec3d next = path_at(path, time);
      if (hook.isZero(0)) {
        work.burnt.push_back(swept_volume({tip, next, radius}));
      } else {
        const Vec3d turned = wire_at(orientation_at(path, time));
        work.burnt.push_back(swept_volume({tip, next, radius}, wire, turned));
        wire = turned;
      }
      tip = next;
    };
    for (auto point = after(path, begin); point != path.end() && point->time < end; ++point)
      sweep_to(point->time);
    sweep_to(end);
  }
}

std::optional<PlacedTool> Cautery::placed(double time, const HeldPoints&) const {
  const bool is_on_path = !strokes.empty() && acts_at(time, strokes.back().recent());
  if ((!is_live || is_away) && !is_on_path) return std::nullopt;
  const ToolPose now = is_live ? pose
                               : ToolPose{path_at(strokes.back().recent(), time),
                                          orientation_at(strokes.back().recent(), time)};
  return PlacedTool{.name = name,
                    .type = Path::type,
                    .position = now.position,
                    .shape = {.radius = radius, .blade = wire_at(now.orientation)},
                    .orientation = now.orientation};
}

bool Cautery::fits(Index) const {
  return radius > 0 && hook.allFinite() && pose.position.allFinite() && !(burns && strokes.empty()) &&
         std::all_of(strokes.begin(), strokes.end(),
                     [](const GrowingPath& stroke) { return is_path(stroke.all()); });
}

}  // namespace lobe
