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
  const Vec3d from = position;
  position = std::exchange(target, std::nullopt).value_or(from);
  if (!burns) return;
  GrowingPath& stroke = strokes.back();
  stroke.forget_after(time);
  if (stroke.empty()) stroke.push_back({start_of_stroke(time), from});
  stroke.push_back({end, position});
}

std::vector<CauterySetup> Cautery::paths() const {
  std::vector<CauterySetup> paths;
  for (const GrowingPath& stroke : strokes)
    if (!stroke.empty()) paths.push_back({name, radius, stroke.all()});
  return paths;
}

void Cautery::add_work(double from, double to, ToolWork& work) const {
  for (const GrowingPath& stroke : strokes) {
    if (stroke.empty() || stroke.back().time < from) continue;
    const std::vector<PathPoint>& path = stroke.recent();
    const double begin = std::max(from, path.front().time), end = std::min(to, path.back().time);
    if (begin > end) continue;
    Vec3d tip = path_at(path, begin);
    for (auto point = after(path, begin); point != path.end() && point->time < end; ++point) {
      work.burnt.push_back(swept_volume({tip, point->position, radius}));
      tip = point->position;
    }
    work.burnt.push_back(swept_volume({tip, path_at(path, end), radius}));
  }
}

std::optional<PlacedTool> Cautery::placed(double time, const HeldPoints&) const {
  const bool is_on_path = !strokes.empty() && acts_at(time, strokes.back().recent());
  if ((!is_live || is_away) && !is_on_path) return std::nullopt;
  return PlacedTool{.name = name,
                    .type = Path::type,
                    .position = is_live ? position : path_at(strokes.back().recent(), time),
                    .shape = shape()};
}

bool Cautery::fits(Index) const {
  return radius > 0 && position.allFinite() && !(burns && strokes.empty()) &&
         std::all_of(strokes.begin(), strokes.end(),
                     [](const GrowingPath& stroke) { return is_path(stroke.all()); });
}

}  // namespace lobe
