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

namespace {

std::vector<PathPoint> heels_of(const ScalpelSetup& setup) {
  std::vector<PathPoint> heels;
  for (std::size_t i = 0; i < setup.heels.size(); ++i) heels.push_back({setup.path[i].time, setup.heels[i]});
  return heels;
}

}  // namespace

Scalpel::Scalpel(const ScalpelSetup& setup)
    : name(setup.name),
      snap(setup.snap),
      along_faces(setup.along_faces),
      strokes{{setup.path, heels_of(setup)}} {}

void Scalpel::Stroke::push_back(double time, const BladePose& at) {
  tips.push_back({time, at.tip});
  heels.push_back({time, at.heel});
}

BladePose Scalpel::Stroke::at(double time) const {
  const std::vector<PathPoint>&from = tips.recent(), &to = heels.recent();
  const auto next = after(from, time);
  const auto row = static_cast<std::size_t>(next - from.begin());
  if (row == 0) return {from.front().position, to.front().position};
  if (next == from.end()) return {from.back().position, to.back().position};
  const double share = (time - from[row - 1].time) / (next->time - from[row - 1].time);
  return {from[row - 1].position + share * (next->position - from[row - 1].position),
          to[row - 1].position + share * (to[row].position - to[row - 1].position)};
}

void Scalpel::turn_on(bool on) {
  if (on && !cuts) {
    settle();
    strokes.emplace_back();
  }
  cuts = on;
}

bool Scalpel::has_ended(double time) const {
  return is_away &&
         (strokes.empty() || strokes.back().tips.empty() || strokes.back().tips.back().time < time);
}

void Scalpel::settle() {
  if (strokes.empty()) return;
  strokes.back().tips.settle();
  strokes.back().heels.settle();
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
  Stroke& stroke = strokes.back();
  stroke.tips.forget_after(time);
  stroke.heels.forget_after(time);
  if (stroke.tips.empty()) stroke.push_back(start_of_stroke(time), from);
  stroke.push_back(end, pose);
}

std::vector<ScalpelSetup> Scalpel::paths() const {
  std::vector<ScalpelSetup> paths;
  for (const Stroke& stroke : strokes) {
    if (stroke.tips.empty()) continue;
    ScalpelSetup& path = paths.emplace_back(ScalpelSetup{name, snap, stroke.tips.all(), {}, along_faces});
    for (const PathPoint& heel : stroke.heels.all()) path.heels.push_back(heel.position);
  }
  return paths;
}

void Scalpel::add_work(double from, double to, ToolWork& work) const {
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (strokes[i].tips.empty()) continue;
    const std::vector<PathPoint>&tips = strokes[i].tips.recent(), &heels = strokes[i].heels.recent();
    const double begin = std::max(from, tips.front().time), end = std::min(to, tips.back().time);
    if (begin > end) continue;
    BladeMove move{id, static_cast<int>(i), snap, strokes[i].at(begin), {}, along_faces};
    for (auto row = after(tips, begin); row != tips.end() && row->time < end; ++row) {
      move.to = {row->position, heels[std::size_t(row - tips.begin())].position};
      work.cuts.push_back(move);
      move.from = move.to;
    }
    move.to = strokes[i].at(end);
    work.cuts.push_back(move);
  }
}

std::optional<PlacedTool> Scalpel::placed(double time, const HeldPoints&) const {
  const bool is_on_path = !strokes.empty() && acts_at(time, strokes.back().tips.recent());
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
    const std::vector<PathPoint> tips = stroke.tips.all(), heels = stroke.heels.all();
    return is_path(tips) && is_path(heels) &&
           std::equal(tips.begin(), tips.end(), heels.begin(), heels.end(),
                      [](const PathPoint& tip, const PathPoint& heel) { return tip.time == heel.time; });
  });
}

}  // namespace lobe
