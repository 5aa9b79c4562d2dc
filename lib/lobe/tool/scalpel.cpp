#include "lobe/tool/scalpel.h"

#include <algorithm>
#include <utility>

#include "lobe/error.h"

namespace lobe {

void BringScalpel::check(Index, const Options&) const {
  if (!pose.tip.allFinite() || !pose.heel.allFinite() || pose.tip == pose.heel ||
      !(snap >= least_snap && snap <= most_snap))
    throw InputError("scalpel",
                     "needs a tip and a heel that are finite and not the same, and a snap of 0.02 to 0.3");
}

BladePose Scalpel::Stroke::at(double time) const {
  const auto next = after(tips, time);
  const auto row = static_cast<std::size_t>(next - tips.begin());
  if (row == 0) return {tips.front().position, heels.front()};
  if (next == tips.end()) return {tips.back().position, heels.back()};
  const double share = (time - tips[row - 1].time) / (next->time - tips[row - 1].time);
  return {tips[row - 1].position + share * (next->position - tips[row - 1].position),
          heels[row - 1] + share * (heels[row] - heels[row - 1])};
}

void Scalpel::turn_on(bool on) {
  if (on && !cuts) strokes.emplace_back();
  cuts = on;
}

// The force along the way is the energy divided by the way. If only the tissue has moved there is no way, and
// no force is computed.
void Scalpel::cut_by(const CutWork& done, const Vec3d& own_way, const Vec3d& tip) {
  work.energy += done.energy;
  work.moment += done.moment;
  way += own_way;
  length += own_way.norm();
  if (!(work.energy > 0) || !(way.norm() > 0)) return;
  force = work.energy / length * way.normalized();
  torque = (work.moment / work.energy - tip).cross(force);
}

void Scalpel::begin_frame(double time, double end) {
  work = {};
  length = 0;
  for (Vec3d* vector : {&way, &force, &torque}) vector->setZero();
  if (!is_live) return;
  const BladePose from = pose;
  if (const auto to = std::exchange(target, std::nullopt))
    pose = {to->position, to->position + Eigen::Quaterniond(to->orientation) * blade};
  if (!cuts) return;
  auto& [tips, heels] = strokes.back();
  forget_after(time, tips);
  heels.resize(tips.size());
  if (tips.empty()) {
    tips.push_back({start_of_stroke(time), from.tip});
    heels.push_back(from.heel);
  }
  tips.push_back({end, pose.tip});
  heels.push_back(pose.heel);
}

std::vector<ScalpelSetup> Scalpel::paths() const {
  std::vector<ScalpelSetup> paths;
  for (const Stroke& stroke : strokes)
    if (!stroke.tips.empty()) paths.push_back({name, snap, stroke.tips, stroke.heels, along_faces});
  return paths;
}

void Scalpel::add_work(double from, double to, ToolWork& work) const {
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const auto& [tips, heels] = strokes[i];
    if (tips.empty()) continue;
    const double begin = std::max(from, tips.front().time), end = std::min(to, tips.back().time);
    if (begin > end) continue;
    BladeMove move{id, static_cast<int>(i), snap, strokes[i].at(begin), {}, along_faces};
    for (auto row = after(tips, begin); row != tips.end() && row->time < end; ++row) {
      move.to = {row->position, heels[std::size_t(row - tips.begin())]};
      work.cuts.push_back(move);
      move.from = move.to;
    }
    move.to = strokes[i].at(end);
    work.cuts.push_back(move);
  }
}

std::optional<PlacedTool> Scalpel::placed(double time, const HeldPoints&) const {
  const bool is_on_path = !strokes.empty() && acts_at(time, strokes.back().tips);
  if ((!is_live || is_away) && !is_on_path) return std::nullopt;
  const BladePose now = is_live ? pose : strokes.back().at(time);
  return PlacedTool{.name = name,
                    .type = Path::type,
                    .position = now.tip,
                    .shape = {.blade = now.heel - now.tip},
                    .force = force,
                    .torque = torque};
}

bool Scalpel::fits(Index) const {
  return !(cuts && strokes.empty()) && std::all_of(strokes.begin(), strokes.end(), [](const Stroke& stroke) {
    return is_path(stroke.tips) && stroke.heels.size() == stroke.tips.size() &&
           std::all_of(stroke.heels.begin(), stroke.heels.end(),
                       [](const Vec3d& x) { return x.allFinite(); });
  });
}

}  // namespace lobe
