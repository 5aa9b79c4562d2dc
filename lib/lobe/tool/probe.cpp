#include "lobe/tool/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"

namespace lobe {

void BringProbe::check(Index, const Options& used) const {
  refuse_excluded(Option::force_terms, used, "probe");
  const Expect expect = [](bool is_met, const std::string& fault) {
    if (!is_met) throw InputError("probe", fault);
  };
  shape.check(expect, "it");
  expect(std::isfinite(friction) && friction >= 0, "needs a friction of at least 0, and finite");
  expect(pose.position.allFinite() && std::abs(pose.orientation.norm() - 1) < 1e-6,
         "needs a finite position and a unit quaternion for its orientation");
  expect(!pose.opening || (*pose.opening >= 0 && std::isfinite(*pose.opening)),
         "needs an opening of at least 0 m, and finite");
}

ToolShape Probe::shape() const {
  const RigidShape& tip = shape_of_tip;
  switch (tip.kind) {
    case RigidShape::Kind::sphere:
      return {.radius = tip.radius};
    case RigidShape::Kind::capsule:
      return {.radius = tip.radius, .blade = tip.length * Vec3d::UnitZ()};
    case RigidShape::Kind::plane:
      return {};
    case RigidShape::Kind::jaws:
      return {.radius = tip.size[0] / 2,
              .blade = tip.size[2] * Vec3d::UnitZ(),
              .opening = opening_now(),
              .jaw = tip.size};
    case RigidShape::Kind::box:
    case RigidShape::Kind::mesh:
      break;
  }
  return {.radius = tip.fineness()};
}

double Probe::goes() const {
  const bool ends = is_live ? is_away : release;
  return ends && !path.empty() ? path.back().time : std::numeric_limits<double>::infinity();
}

// A row says where it is from `time` on only if nothing has said so before.
void Probe::begin_frame(double time, double end) {
  if (!is_live) return;
  if (is_away) return path.settle();
  path.forget_after(time);
  is_away = release;
  if (is_away && path.empty()) return;
  if (path.empty()) path.push_back({time, pose.position, pose.orientation, pose.opening.value_or(0)});
  const PathPoint last = path.back();
  const double opening = next_opening(last, end - time);
  const bool moves = target || opening != last.opening;
  if ((moves || release) && last.time < time - just_before)
    path.push_back({time, last.position, last.orientation, last.opening});
  if (release || !moves) return;
  const ToolPose to = std::exchange(target, std::nullopt).value_or(ToolPose{last.position, last.orientation});
  path.push_back({end, to.position, to.orientation, opening});
}

// The opening that the hand leads to, or that of jaws which close by themselves.
double Probe::next_opening(const PathPoint& from, double duration) const {
  if (target && target->opening) return *target->opening;
  if (shape_of_tip.kind != RigidShape::Kind::jaws) return from.opening;
  if (closes) return grip < most_grip ? std::max(0.0, from.opening - jaw_speed * duration) : from.opening;
  const double widest = std::max(from.opening, pose.opening.value_or(0));
  return std::min(widest, from.opening + jaw_speed * duration);
}

std::vector<ProbeSetup> Probe::paths() const {
  if (path.empty()) return {};
  return {{name, shape_of_tip, friction, path.all(), release}};
}

void Probe::append_bodies(double from, double to, std::vector<ToolBody>& bodies) const {
  append_body({id, &shape_of_tip, friction, 0, goes()}, path, from, to, bodies);
}

std::optional<PlacedTool> Probe::placed(double time, const HeldPoints&) const {
  const bool was_just_brought = is_live && path.empty() && !is_away;
  const bool is_there =
      !path.empty() && time >= path.front().time - just_before && time < goes() - just_before;
  if (!was_just_brought && !is_there) return std::nullopt;
  const ToolPose now =
      path.empty() ? pose : ToolPose{path_at(path.recent(), time), orientation_at(path.recent(), time)};
  ToolShape drawn = shape();
  drawn.blade = Eigen::Quaterniond(now.orientation) * drawn.blade;
  drawn.opening = path.empty() ? pose.opening.value_or(0) : opening_at(path.recent(), time);
  return PlacedTool{.name = name,
                    .type = Path::type,
                    .position = now.position,
                    .shape = drawn,
                    .orientation = now.orientation,
                    .force = force,
                    .torque = torque};
}

bool Probe::fits(Index) const {
  bool is_whole = true;
  const Expect expect = [&](bool is_met, const std::string&) { is_whole = is_whole && is_met; };
  shape_of_tip.check(expect, "");
  return is_whole && std::isfinite(friction) && friction >= 0 && is_path(path.all()) &&
         (is_live || !path.empty()) && pose.position.allFinite() && std::isfinite(grip) &&
         force.allFinite() && torque.allFinite();
}

}  // namespace lobe
