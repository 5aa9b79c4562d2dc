#include "lobe/tool/tools.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"

namespace lobe {
namespace {

template <class Tool>
auto found(std::vector<Tool>& tools, ToolId id) {
  return std::find_if(tools.begin(), tools.end(), [&](const Tool& tool) { return tool.id == id; });
}

[[noreturn]] void refuse(ToolId id, const std::string& why) {
  throw InputError("tool " + std::to_string(id), why);
}

void check(ToolId id, const ToolPose& pose) {
  if (!pose.position.allFinite() || !(std::abs(pose.orientation.norm() - 1) < 1e-6))
    refuse(id, "needs a finite position and a unit quaternion for its orientation");
}

auto after(const std::vector<PathPoint>& path, double time) {  // the first row of it
  return std::upper_bound(path.begin(), path.end(), time,
                          [](double t, const PathPoint& point) { return t < point.time; });
}

}  // namespace

Tools::Tools(const Setup& setup) {
  for (const GraspSetup& grasp : setup.grasps)
    grasps_.push_back({.id = next_++,
                       .name = grasp.name,
                       .vertices = grasp.vertices,
                       .path = grasp.path,
                       .release = grasp.release});
  for (const CauterySetup& cautery : setup.cauteries)
    cauteries_.push_back(
        {.id = next_++, .name = cautery.name, .radius = cautery.radius, .strokes = {cautery.path}});
  for (const ScalpelSetup& scalpel : setup.scalpels)
    scalpels_.push_back({.id = next_++,
                         .name = scalpel.name,
                         .snap = scalpel.snap,
                         .strokes = {{scalpel.path, scalpel.heels}},
                         .pose = {}});
  placed_.resize(std::size_t(next_));
}

const Grasp* Tools::grasp(ToolId id) const {
  const auto at = found(const_cast<std::vector<Grasp>&>(grasps_), id);
  return at == grasps_.end() ? nullptr : &*at;
}

const Cautery* Tools::cautery(ToolId id) const {
  const auto at = found(const_cast<std::vector<Cautery>&>(cauteries_), id);
  return at == cauteries_.end() ? nullptr : &*at;
}

const Scalpel* Tools::scalpel(ToolId id) const {
  const auto at = found(scalpels_, id);
  return at == scalpels_.end() ? nullptr : &*at;
}

Grasp& Tools::live_grasp(ToolId id) {
  const auto at = found(grasps_, id);
  if (at == grasps_.end()) refuse(id, "is not there, or no grasp");
  if (!at->is_live) refuse(id, "follows the path of its scene");
  if (at->release) refuse(id, "has let go");
  return *at;
}

Cautery& Tools::live_cautery(ToolId id) {
  const auto at = found(cauteries_, id);
  if (at == cauteries_.end()) refuse(id, "is not there, or no cautery");
  if (!at->is_live) refuse(id, "follows the path of its scene");
  if (at->is_away) refuse(id, "was taken away");
  return *at;
}

void Tools::add(Grasp grasp) {
  grasp.id = next_++;
  grasp.is_live = true;
  placed_.resize(std::size_t(next_));
  grasps_.push_back(std::move(grasp));
}

void Tools::add(Cautery cautery) {
  if (!(cautery.radius > 0) || !std::isfinite(cautery.radius) || !cautery.position.allFinite())
    refuse(next_, "needs a radius above 0 and a finite position");
  cautery.id = next_++;
  cautery.is_live = true;
  placed_.resize(std::size_t(next_));
  cauteries_.push_back(std::move(cautery));
}

Scalpel* Tools::live_scalpel(ToolId id) {
  const auto at = found(scalpels_, id);
  if (at == scalpels_.end()) return nullptr;
  if (!at->is_live) refuse(id, "follows the path of its scene");
  if (at->is_away) refuse(id, "was taken away");
  return &*at;
}

void Tools::add(Scalpel scalpel) {
  if (!scalpel.pose.tip.allFinite() || !scalpel.pose.heel.allFinite() ||
      scalpel.pose.tip == scalpel.pose.heel || !(scalpel.snap >= least_snap && scalpel.snap <= most_snap))
    refuse(next_, "needs a tip and a heel that are finite and not the same, and a snap of 0.02 to 0.3");
  scalpel.id = next_++;
  scalpel.is_live = true;
  scalpel.blade = scalpel.pose.heel - scalpel.pose.tip;
  placed_.resize(std::size_t(next_));
  scalpels_.push_back(std::move(scalpel));
}

void Tools::lead(ToolId id, const ToolPose& target) {
  check(id, target);
  if (has_grasp(id))
    live_grasp(id).target = target;
  else if (Scalpel* scalpel = live_scalpel(id))
    scalpel->target = target;
  else
    live_cautery(id).target = target.position;
}

void Tools::let_go(ToolId id) {
  if (has_grasp(id)) {
    live_grasp(id).release = true;
  } else {
    turn_on(id, false);
    Scalpel* scalpel = live_scalpel(id);
    (scalpel ? scalpel->is_away : live_cautery(id).is_away) = true;
  }
}

void Tools::turn_on(ToolId id, bool on) {
  if (Scalpel* scalpel = live_scalpel(id)) {
    if (on && !scalpel->is_on) scalpel->strokes.emplace_back();
    scalpel->is_on = on;
    return;
  }
  Cautery& cautery = live_cautery(id);
  if (on && !cautery.is_on) cautery.strokes.emplace_back();
  cautery.is_on = on;
}

std::vector<GraspSetup> Tools::grasp_paths() const {
  std::vector<GraspSetup> paths;
  for (const Grasp& grasp : grasps_)
    if (!grasp.path.empty()) paths.push_back({grasp.name, grasp.vertices, grasp.path, grasp.release});
  return paths;
}

std::vector<CauterySetup> Tools::cautery_paths() const {
  std::vector<CauterySetup> paths;
  for (const Cautery& cautery : cauteries_)
    for (const std::vector<PathPoint>& stroke : cautery.strokes)
      if (!stroke.empty()) paths.push_back({cautery.name, cautery.radius, stroke});
  return paths;
}

std::vector<ScalpelSetup> Tools::scalpel_paths() const {
  std::vector<ScalpelSetup> paths;
  for (const Scalpel& scalpel : scalpels_)
    for (const Scalpel::Stroke& stroke : scalpel.strokes)
      if (!stroke.tips.empty()) paths.push_back({scalpel.name, scalpel.snap, stroke.tips, stroke.heels});
  return paths;
}

// A row says where a tool is from `time` on only if nothing has said so before. Rows that are later are of a
// frame that did not come about.
void Tools::begin_frame(double time, double duration) {
  frame_end_ = time + duration;
  time_felt_ = 0;
  impulses_.assign(placed_.size(), {});
  const auto forget_later = [&](std::vector<PathPoint>& path) {
    while (!path.empty() && path.back().time > time + just_before) path.pop_back();
  };
  const auto continue_at = [&](std::vector<PathPoint>& path) {
    if (path.back().time < time - just_before)
      path.push_back({time, path.back().position, path.back().orientation});
  };
  for (Grasp& grasp : grasps_) {
    if (!grasp.is_live || grasp.phase == Grasp::Phase::released) continue;
    forget_later(grasp.path);
    if (grasp.path.empty()) grasp.path.push_back({time, Vec3d::Zero()});
    if (grasp.target || grasp.release) continue_at(grasp.path);
    if (!grasp.target || grasp.release || grasp.phase != Grasp::Phase::holding) continue;
    const ToolPose target = *std::exchange(grasp.target, std::nullopt);
    grasp.path.push_back({frame_end_, target.position - grasp.centre, target.orientation});
  }
  for (Cautery& cautery : cauteries_) {
    if (!cautery.is_live) continue;
    const Vec3d from = cautery.position;
    cautery.position = std::exchange(cautery.target, std::nullopt).value_or(from);
    if (!cautery.is_on) continue;
    std::vector<PathPoint>& stroke = cautery.strokes.back();
    forget_later(stroke);
    // Just after the frame's start: as a path of a scene it would else begin at the end of the frame before.
    if (stroke.empty())
      stroke.push_back({std::nextafter(time, std::numeric_limits<double>::infinity()), from});
    stroke.push_back({frame_end_, cautery.position});
  }
  continue_strokes(time);
}

void Tools::continue_strokes(double time) {
  for (Scalpel& scalpel : scalpels_) {
    if (!scalpel.is_live) continue;
    const BladePose from = scalpel.pose;
    if (const auto target = std::exchange(scalpel.target, std::nullopt))
      scalpel.pose = {target->position,
                      target->position + Eigen::Quaterniond(target->orientation) * scalpel.blade};
    if (!scalpel.is_on) continue;
    auto& [tips, heels] = scalpel.strokes.back();
    while (!tips.empty() && tips.back().time > time + just_before) tips.pop_back();
    heels.resize(tips.size());
    if (tips.empty()) {
      tips.push_back({std::nextafter(time, std::numeric_limits<double>::infinity()), from.tip});
      heels.push_back(from.heel);
    }
    tips.push_back({frame_end_, scalpel.pose.tip});
    heels.push_back(scalpel.pose.heel);
  }
}

BladePose pose_at(const Scalpel::Stroke& stroke, double time) {
  const auto next = after(stroke.tips, time);
  const auto at = static_cast<std::size_t>(next - stroke.tips.begin());
  if (at == 0) return {stroke.tips.front().position, stroke.heels.front()};
  if (next == stroke.tips.end()) return {stroke.tips.back().position, stroke.heels.back()};
  const double share = (time - stroke.tips[at - 1].time) / (next->time - stroke.tips[at - 1].time);
  return {stroke.tips[at - 1].position + share * (next->position - stroke.tips[at - 1].position),
          stroke.heels[at - 1] + share * (stroke.heels[at] - stroke.heels[at - 1])};
}

std::vector<BladeMove> Tools::blade_moves(double from, double to) const {
  std::vector<BladeMove> moves;
  for (const Scalpel& scalpel : scalpels_)
    for (std::size_t i = 0; i < scalpel.strokes.size(); ++i) {
      const auto& [tips, heels] = scalpel.strokes[i];
      if (tips.empty()) continue;
      const double begin = std::max(from, tips.front().time), end = std::min(to, tips.back().time);
      if (begin > end) continue;
      BladeMove move{scalpel.id, static_cast<int>(i), scalpel.snap, pose_at(scalpel.strokes[i], begin), {}};
      for (auto row = after(tips, begin); row != tips.end() && row->time < end; ++row) {
        move.to = {row->position, heels[std::size_t(row - tips.begin())]};
        moves.push_back(move);
        move.from = move.to;
      }
      move.to = pose_at(scalpel.strokes[i], end);
      moves.push_back(move);
    }
  return moves;
}

double Tools::next_grasp_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Grasp& grasp : grasps_) {
    if (grasp.path.empty()) continue;
    if (grasp.path.front().time > time) next = std::min(next, grasp.path.front().time);
    if (grasp.release && grasp.path.back().time > time) next = std::min(next, grasp.path.back().time);
  }
  return next;
}

std::vector<Sweep> Tools::sweeps(double from, double to) const {
  std::vector<Sweep> sweeps;
  for (const Cautery& c : cauteries_)
    for (const std::vector<PathPoint>& path : c.strokes) {
      if (path.empty()) continue;
      const double begin = std::max(from, path.front().time), end = std::min(to, path.back().time);
      if (begin > end) continue;
      Vec3d tip = path_at(path, begin);
      for (auto point = after(path, begin); point != path.end() && point->time < end; ++point) {
        sweeps.push_back({tip, point->position, c.radius});
        tip = point->position;
      }
      sweeps.push_back({tip, path_at(path, end), c.radius});
    }
  return sweeps;
}

void Tools::place(double time) {
  const double now = std::min(time, frame_end_);
  for (const Grasp& grasp : grasps_) {
    if (grasp.phase != Grasp::Phase::holding) continue;
    Placed& placed = placed_[std::size_t(grasp.id)];
    placed.offset = path_at(grasp.path, now);
    const Eigen::Vector4d turn = turn_at(grasp.path, now);
    placed.is_turned = turn != Eigen::Vector4d(0, 0, 0, 1);
    if (placed.is_turned) placed.turn = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  }
}

Vec3d Tools::displacement(const HeldVertices::Held& item, const Vec3d& rest) const {
  const Placed& placed = placed_[std::size_t(item.holder)];
  if (!placed.is_turned) return item.start + placed.offset;
  const Vec3d& centre = grasp(item.holder)->centre;
  const Vec3d arm = rest + item.start - centre;
  return centre + placed.offset + placed.turn * arm - rest;
}

void Tools::begin_forces() { impulses_of_part_.assign(placed_.size(), {}); }

void Tools::add_force(ToolId holder, const Vec3d& force, const Vec3d& x, double dt) {
  Impulse& impulse = impulses_of_part_[std::size_t(holder)];
  impulse.linear += dt * force;
  impulse.angular += dt * (x - position(*grasp(holder))).cross(force);
}

void Tools::end_forces(double duration) {
  time_felt_ += duration;
  for (Grasp& grasp : grasps_) {
    Impulse& impulse = impulses_[std::size_t(grasp.id)];
    impulse.linear += impulses_of_part_[std::size_t(grasp.id)].linear;
    impulse.angular += impulses_of_part_[std::size_t(grasp.id)].angular;
    grasp.force = impulse.linear / time_felt_;
    grasp.torque = impulse.angular / time_felt_;
  }
}

void Tools::set_state(const State& state) {
  grasps_ = state.grasps;
  cauteries_ = state.cauteries;
  scalpels_ = state.scalpels;
  next_ = state.next;
  placed_.assign(std::size_t(next_), {});
}

bool Tools::fits(const State& state, Index vertices, const Setup& setup) {
  ToolId last = 0;
  const auto is_path = [](const std::vector<PathPoint>& path) {
    for (std::size_t i = 0; i < path.size(); ++i)
      if (!std::isfinite(path[i].time) || !path[i].position.allFinite() ||
          !(std::abs(path[i].orientation.norm() - 1) < 1e-6) || (i > 0 && !(path[i].time > path[i - 1].time)))
        return false;
    return true;
  };
  const auto is_new = [&](ToolId id) { return id > std::exchange(last, id) && id < state.next; };
  const auto of_scene = [](const auto& tools) {
    return std::count_if(tools.begin(), tools.end(), [](const auto& tool) { return !tool.is_live; });
  };
  if (state.next < 1 || state.next > 1'000'000 ||
      of_scene(state.grasps) != std::ptrdiff_t(setup.grasps.size()) ||
      of_scene(state.cauteries) != std::ptrdiff_t(setup.cauteries.size()) ||
      of_scene(state.scalpels) != std::ptrdiff_t(setup.scalpels.size()))
    return false;
  for (const Grasp& grasp : state.grasps) {
    for (Index v : grasp.vertices)
      if (v < 0 || (grasp.is_live && v >= vertices)) return false;
    if (!is_new(grasp.id) || !is_path(grasp.path) || !grasp.centre.allFinite()) return false;
    if (grasp.path.empty() && (!grasp.is_live || grasp.phase != Grasp::Phase::waiting)) return false;
  }
  last = 0;
  for (const Cautery& cautery : state.cauteries) {
    if (!is_new(cautery.id) || !(cautery.radius > 0) || !cautery.position.allFinite()) return false;
    if (cautery.is_on && cautery.strokes.empty()) return false;
    if (!std::all_of(cautery.strokes.begin(), cautery.strokes.end(), is_path)) return false;
  }
  last = 0;
  for (const Scalpel& scalpel : state.scalpels) {
    if (!is_new(scalpel.id) || (scalpel.is_on && scalpel.strokes.empty())) return false;
    for (const Scalpel::Stroke& stroke : scalpel.strokes)
      if (!is_path(stroke.tips) || stroke.heels.size() != stroke.tips.size() ||
          !std::all_of(stroke.heels.begin(), stroke.heels.end(),
                       [](const Vec3d& x) { return x.allFinite(); }))
        return false;
  }
  return true;
}

}  // namespace lobe
