#include "lobe/tool/cautery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"

namespace lobe {

namespace {

RigidShape core_of(const Vec3d& hook, double radius) {
  return hook.isZero(0) ? RigidShape::sphere(radius) : RigidShape::capsule(radius, hook.norm());
}

}  // namespace

Cautery::Cautery(const CauterySetup& setup)
    : name(setup.name),
      radius(setup.radius),
      strokes{setup.path},
      hook(setup.hook),
      core(core_of(setup.hook, setup.core)) {
  if (core.radius == 0) return;
  std::vector<PathPoint> rows;
  for (const PathPoint& row : setup.path) rows.push_back(core_at(row.time, {row.position, row.orientation}));
  core_path = GrowingPath(std::move(rows));
}

Cautery::Cautery(const BringCautery& command)
    : name(command.name),
      radius(command.radius),
      is_live(true),
      hook(command.hook),
      pose{command.position},
      core(core_of(command.hook, command.core)) {}

void BringCautery::check(Index, const Options& used) const {
  if (core > 0) refuse_excluded(Option::force_terms, used, "cautery with a core");
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError("cautery", "needs a radius above 0 m, and finite");
  if (!position.allFinite()) throw InputError("cautery", "needs a finite position");
  if (!hook.allFinite()) throw InputError("cautery", "needs a finite hook");
  if (!(core >= 0 && core < radius))
    throw InputError("cautery", "needs a core of at least 0 m that is thinner than it");
}

void Cautery::turn_on(bool on) {
  if (on && !burns) {
    settle();
    strokes.emplace_back();
  }
  burns = on;
}

bool Cautery::has_ended(double time) const {
  const bool has_cooled = strokes.empty() || strokes.back().empty() || strokes.back().back().time < time;
  const bool is_felt = core.radius > 0 && !core_path.empty() && (!has_left || core_path.back().time >= time);
  return is_away && has_cooled && !is_felt;
}

void Cautery::settle() {
  if (!strokes.empty()) strokes.back().settle();
}

// ---- Its core

PathPoint Cautery::core_at(double time, const ToolPose& at) const {
  const auto along =
      Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), hook.isZero(0) ? Vec3d::UnitZ() : hook);
  return {time, at.position, (Eigen::Quaterniond(at.orientation) * along).normalized().coeffs()};
}

double Cautery::core_goes() const {
  const bool ends = !is_live || has_left;
  return ends && !core_path.empty() ? core_path.back().time : std::numeric_limits<double>::infinity();
}

// As a probe does.
void Cautery::move_core(double time, double end, const ToolPose& from) {
  if (has_left) return core_path.settle();
  core_path.forget_after(time);
  has_left = is_away;
  if (has_left && core_path.empty()) return;
  if (core_path.empty()) core_path.push_back(core_at(time, from));
  const bool moves = from.position != pose.position || from.orientation != pose.orientation;
  if ((moves || has_left) && core_path.back().time < time - just_before)
    core_path.push_back(core_at(time, from));
  if (moves && !has_left) core_path.push_back(core_at(end, pose));
}

std::vector<ProbeSetup> Cautery::core_paths() const {
  if (!is_live || core_path.empty()) return {};
  return {{name, core, default_friction, core_path.all(), has_left}};
}

void Cautery::append_bodies(double from, double to, std::vector<ToolBody>& bodies) const {
  if (core.radius > 0)
    append_body({id, &core, default_friction, 0, core_goes()}, core_path, from, to, bodies);
}

// ---- A frame

void Cautery::begin_frame(double time, double end) {
  if (!is_live) return;
  const ToolPose from = pose;
  if (const auto to = std::exchange(target, std::nullopt)) pose = *to;
  if (core.radius > 0) move_core(time, end, from);
  if (!burns) return;
  GrowingPath& stroke = strokes.back();
  stroke.forget_after(time);
  if (stroke.empty()) stroke.push_back({start_of_stroke(time), from.position, from.orientation});
  stroke.push_back({end, pose.position, pose.orientation});
}

std::vector<CauterySetup> Cautery::paths() const {
  std::vector<CauterySetup> paths;
  for (const GrowingPath& stroke : strokes)
    if (!stroke.empty()) paths.push_back({name, radius, stroke.all(), hook, is_live ? 0 : core.radius});
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
                    .orientation = now.orientation,
                    .force = force,
                    .torque = torque};
}

bool Cautery::fits(Index) const {
  return radius > 0 && core.radius >= 0 && is_path(core_path.all()) && force.allFinite() &&
         torque.allFinite() && hook.allFinite() && pose.position.allFinite() && !(burns && strokes.empty()) &&
         std::all_of(strokes.begin(), strokes.end(),
                     [](const GrowingPath& stroke) { return is_path(stroke.all()); });
}

}  // namespace lobe
