#include "lobe/tool/needle.h"

#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"

namespace lobe {

void BringNeedle::check(Index, const Options& used) const {
  refuse_excluded(Option::force_terms, used, "needle");
  const Expect expect = [](bool is_met, const std::string& fault) {
    if (!is_met) throw InputError("needle", fault);
  };
  const std::string fault = settings.fault();
  expect(fault.empty(), fault);
  expect(!thread || *thread >= 0, "needs a number of its thread that is at least 0");
  if (thread) material.check(expect, "its thread");
  expect(is_thread_length(thread_length), "needs a thread of a length above 0 m, and finite");
  expect(pose.position.allFinite() && std::abs(pose.orientation.norm() - 1) < 1e-6,
         "needs a finite position and a unit quaternion for its orientation");
}

ToolShape Needle::shape() const {
  return {.radius = settings.shape.thickness / 2, .blade = settings.shape.place(settings.shape.length())};
}

double Needle::goes() const {
  const bool ends = is_live ? is_away : release;
  return ends && !path.empty() ? path.back().time : std::numeric_limits<double>::infinity();
}

// As a probe does.
void Needle::begin_frame(double time, double end) {
  if (!is_live) return;
  if (is_away) return path.settle();
  path.forget_after(time);
  is_away = release;
  if (is_away && path.empty()) return;
  if (path.empty()) path.push_back({time, pose.position, pose.orientation});
  const PathPoint last = path.back();
  if ((target || release) && last.time < time - just_before)
    path.push_back({time, last.position, last.orientation});
  if (release) return;
  if (const auto to = std::exchange(target, std::nullopt))
    path.push_back({end, to->position, to->orientation});
}

std::vector<NeedleSetup> Needle::paths() const {
  if (path.empty()) return {};
  return {{name, settings, thread, material, thread_length, ties, path.all(), release}};
}

void Needle::append_needles(double from, double to, std::vector<NeedleBody>& needles) const {
  if (path.empty() || path.front().time > to - just_before || goes() < from) return;
  const std::vector<PathPoint>& rows = path.recent();
  auto first = after(rows, from), last = after(rows, to);
  if (first != rows.begin()) --first;
  if (last != rows.end()) ++last;
  needles.push_back({id, name, settings, path.front().time, goes(), {first, last}});
}

std::optional<PlacedTool> Needle::placed(double time, const HeldPoints&) const {
  const bool was_just_brought = is_live && path.empty() && !is_away;
  const bool is_there =
      !path.empty() && time >= path.front().time - just_before && time < goes() - just_before;
  if (!was_just_brought && !is_there) return std::nullopt;
  const ToolPose now =
      path.empty() ? pose : ToolPose{path_at(path.recent(), time), orientation_at(path.recent(), time)};
  ToolShape drawn = shape();
  drawn.blade = Eigen::Quaterniond(now.orientation) * drawn.blade;
  return PlacedTool{.name = name,
                    .type = Path::type,
                    .position = now.position,
                    .shape = drawn,
                    .orientation = now.orientation,
                    .force = force,
                    .torque = torque};
}

bool Needle::fits(Index) const {
  bool is_whole = settings.is_valid() && (!thread || *thread >= 0) && is_thread_length(thread_length);
  const auto see = [&](bool is_met, const std::string&) { is_whole = is_whole && is_met; };
  for (const TieSetup& tie : ties) tie.check(see, "");
  if (thread) material.check(see, "");
  return is_whole && is_path(path.all()) && (is_live || !path.empty()) && pose.position.allFinite() &&
         force.allFinite() && torque.allFinite();
}

}  // namespace lobe
