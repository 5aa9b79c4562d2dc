#include "lobe/forces/needles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/error.h"
#include "lobe/forces/inverse_mass.h"
#include "lobe/text.h"
#include "lobe/tool/paths.h"

namespace lobe {
namespace {

constexpr double unlimited_friction = std::numeric_limits<double>::infinity();

}  // namespace

// ---- Needles in the frame

template <class Real>
bool Needles<Real>::Needle::is_there(double time) const {
  return !path.empty() && time >= appears - just_before && time < goes - just_before;
}

template <class Real>
NeedlePose Needles<Real>::Needle::pose(double time) const {
  return {path_at(path, time),
          Eigen::Quaterniond(orientation_at(path, time)).normalized().toRotationMatrix()};
}

template <class Real>
bool Needles<Real>::see(std::span<const NeedleBody> bodies, double from, double to) {
  from_ = from;
  to_ = to;
  std::vector<Needle> now;
  std::vector<int> there;
  for (const NeedleBody& body : bodies) {
    Needle& needle = now.emplace_back();
    const auto before = std::find_if(state_.needles.begin(), state_.needles.end(),
                                     [&](const Needle& other) { return other.tool == body.tool; });
    if (before != state_.needles.end()) needle = std::move(*before);
    needle.tool = body.tool;
    needle.name = body.name;
    needle.settings = body.settings;
    needle.appears = body.appears;
    needle.goes = body.goes;
    needle.path.assign(body.path.begin(), body.path.end());
    if (needle.is_there(from)) there.push_back(needle.tool);
  }
  std::sort(now.begin(), now.end(), [](const Needle& a, const Needle& b) { return a.tool < b.tool; });
  state_.needles = std::move(now);
  scratch_.resize(state_.needles.size());
  std::sort(there.begin(), there.end());
  return std::exchange(there_, there) != there;
}

template <class Real>
std::optional<NeedleEnd> Needles<Real>::end_of(int tool, double from, double to) const {
  for (const Needle& needle : state_.needles) {
    if (needle.tool != tool || needle.path.empty()) continue;
    const NeedleShape& shape = needle.settings.shape;
    const NeedlePose last = needle.pose(to);
    NeedleEnd end{tool, needle.pose(from).place(shape, shape.length()), last.place(shape, shape.length())};
    end.arm = end.to - last.centre;
    return end;
  }
  return {};
}

template <class Real>
bool Needles<Real>::is_there(int tool, double time) const {
  return std::any_of(state_.needles.begin(), state_.needles.end(),
                     [&](const Needle& needle) { return needle.tool == tool && needle.is_there(time); });
}

template <class Real>
void Needles<Real>::see_body(const BodyView& body, const At&) {
  grains_ = body.grains;
  surface_ = &body.surface;
  const Revisions& now = body.model.revisions;
  if (seen_structure_ == now.structure && seen_inertia_ == now.inertia &&
      inverse_mass_.cols() == Eigen::Index(body.mass.size()))
    return;
  seen_structure_ = now.structure;
  seen_inertia_ = now.inertia;
  set_inverse_mass(body, inverse_mass_);
}

// ---- Forces

template <class Real>
Vec3d Needles<Real>::mobility(const EmbeddedPoint& p, const EmbeddedPoint& q,
                              const Topology& topology) const {
  const Eigen::Vector4i at = topology.corners(p.tet), other = topology.corners(q.tet);
  Vec3d sum = Vec3d::Zero();
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      if (at[i] == other[k]) sum += p.weights[i] * q.weights[k] * inverse_mass_.col(at[i]);
  return sum;
}

template <class Real>
Vec3d Needles<Real>::end_velocity(Index vertex, const At& at, const Mat3X<Real>& f) const {
  const Vec3d force = f.col(vertex).template cast<double>(), inverse = inverse_mass_.col(vertex);
  Vec3d v = at.v.col(vertex).template cast<double>();
  for (int i = 0; i < 3; ++i)
    if (inverse[i] != 0) v[i] = at.kick.keep * v[i] + at.kick.push * inverse[i] * force[i];
  return v;
}

// The points on a needle: its holds, and last the one that its tip touches.
template <class Real>
void Needles<Real>::place(const Needle& needle, Scratch& scratch, const At& at, double time,
                          const Mat3X<Real>* f) {
  const NeedlePassage& passage = needle.passage;
  const NeedleShape& shape = needle.settings.shape;
  const Topology& topology = at.model.elements.topology;
  const NeedlePose pose = needle.pose(time), before = needle.pose(at.time);
  const std::size_t holds = passage.holds.size(), count = holds + passage.touches();
  const auto point_of = [&](std::size_t i) -> const EmbeddedPoint& {
    return i < holds ? passage.holds[i].point : passage.at;
  };
  scratch.guide.couple(count, [&](std::size_t a, std::size_t b) -> Vec3d {
    if (!f) return Vec3d::Zero();
    return mobility(point_of(a), point_of(b), topology);
  });
  passage.share_length(shape, scratch.lengths);
  scratch.ways.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    NeedleGuide::Point& point = scratch.guide.points()[i];
    const EmbeddedPoint& where = point_of(i);
    const double s = i < holds ? passage.holds[i].s : 0;
    point.x = position(where, at.model.elements, at.u);
    point.c = pose.place(shape, s);
    point.along = pose.forward(shape, s);
    point.friction = i < holds ? needle.settings.friction * scratch.lengths[i] : unlimited_friction;
    point.slip = i < holds ? passage.holds[i].slip : 0;
    scratch.ways[i] = point.c - before.place(shape, s);
    if (!f) continue;
    const Eigen::Vector4i corners = topology.corners(where.tet);
    for (int c = 0; c < 4; ++c) point.v += where.weights[c] * end_velocity(corners[c], at, *f);
  }
}

// A tip that would have to pull at the surface comes off it: along the needle, or from outside also along the
// normal, as where a lip turns aside and it slides off. Times are at most the end of the frame, so that no
// later row of a path matters.
template <class Real>
void Needles<Real>::solve(Needle& needle, Scratch& scratch, const At& at, const Mat3X<Real>& f) {
  NeedlePassage& passage = needle.passage;
  scratch.punctures = false;
  for (int i = 0; i < 2; ++i) {
    place(needle, scratch, at, std::min(at.time + at.kick.dt, to_), &f);
    scratch.guide.solve(at.kick.dt, at.kick.push);
    if (!passage.touches()) return;
    const NeedleGuide::Point& tip = scratch.guide.points().back();
    needle.pressed = tip.force.dot(tip.along);
    scratch.punctures = needle.pressed >= needle.settings.puncture;
    const bool slides_off =
        passage.tip == NeedlePassage::Tip::pushing && tip.force.dot(outwards(passage, at)) > 0;
    if (needle.pressed >= 0 && !slides_off) return;
    needle.pressed = 0;
    scratch.punctures = false;
    passage.come_off();
  }
}

template <class Real>
void Needles<Real>::add(Needle& needle, const Scratch& scratch, const At& at, Mat3X<Real>& f) {
  NeedlePassage& passage = needle.passage;
  const Vec3d centre = path_at(needle.path, at.time);
  const std::vector<NeedleGuide::Point>& points = scratch.guide.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& force = points[i].force;
    const bool is_hold = i < passage.holds.size();
    (is_hold ? passage.holds[i].force : passage.force) = force;
    add_force(is_hold ? passage.holds[i].point : passage.at, at.model.elements.topology, force, f);
    needle.force += force;
    needle.torque += (points[i].c - centre).cross(force);
  }
  if (needle.tool > 0)
    on_tools_.push_back({.tool = needle.tool, .force = needle.force, .torque = needle.torque});
}

// Outside of steps the forces are those of the last one: springs so stiff are no part of what limits steps.
template <class Real>
void Needles<Real>::add_last(const Needle& needle, const At& at, Mat3X<Real>& f) const {
  const NeedlePassage& passage = needle.passage;
  const Topology& topology = at.model.elements.topology;
  for (const NeedleHold& hold : passage.holds) add_force(hold.point, topology, hold.force, f);
  if (passage.touches()) add_force(passage.at, topology, passage.force, f);
}

template <class Real>
void Needles<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  on_tools_.clear();
  is_solved_ = at.kick.dt > 0;
  if (is_solved_) time_ = at.time;
  scratch_.resize(state_.needles.size());
  for (std::size_t i = 0; i < state_.needles.size(); ++i) {
    Needle& needle = state_.needles[i];
    if (!is_solved_) {
      add_last(needle, at, f);
      continue;
    }
    Scratch& scratch = scratch_[i];
    scratch.guide.points().clear();
    needle.force = needle.torque = Vec3d::Zero();
    needle.pressed = 0;
    if (!needle.is_there(at.time)) {
      needle.passage.clear();
      continue;
    }
    move_tip(needle, scratch, at, f);
    if (!needle.passage.is_in_tissue()) continue;
    solve(needle, scratch, at, f);
    add(needle, scratch, at, f);
  }
}

template <class Real>
double Needles<Real>::energy(const At& at) {
  double sum = 0;
  for (const Needle& needle : state_.needles) {
    if (!needle.is_there(at.time) || !needle.passage.is_in_tissue()) continue;
    Scratch own;
    place(needle, own, at, at.time, nullptr);
    for (const NeedleGuide::Point& point : own.guide.points())
      sum += NeedleGuide::force_at_rest(point).squaredNorm() / (2 * NeedleGuide::stiffness);
  }
  return sum;
}

template <class Real>
std::vector<Index> Needles<Real>::acts_on(const Model& model) const {
  const Topology& topology = model.elements.topology;
  std::vector<Index> vertices;
  const auto add = [&](const EmbeddedPoint& point) {
    if (!exists(point, topology))
      throw InputError("checkpoint", "has a needle in tetrahedron " + std::to_string(point.tet) +
                                         ", which the body does not have");
    for (const Index v : topology.corners(point.tet)) vertices.push_back(v);
  };
  for (const Needle& needle : state_.needles) {
    for (const NeedleHold& hold : needle.passage.holds) add(hold.point);
    if (needle.passage.tip != NeedlePassage::Tip::free) add(needle.passage.at);
  }
  for (const Index v : state_.near)
    if (v < topology.vertex_count()) vertices.push_back(v);
  return vertices;
}

// ---- After a step

template <class Real>
void Needles<Real>::take_back_steps() {
  std::swap(saved_.near, state_.near);  // those of the frame, which may have been found anew
  state_ = saved_;
  is_solved_ = false;
}

template <class Real>
void Needles<Real>::end_step(double, double) {
  if (!std::exchange(is_solved_, false)) return;
  for (std::size_t n = 0; n < state_.needles.size(); ++n) {
    NeedlePassage& passage = state_.needles[n].passage;
    const Scratch& scratch = scratch_[n];
    const std::vector<NeedleGuide::Point>& points = scratch.guide.points();
    if (points.empty()) continue;
    state_.ledger.friction += scratch.guide.friction_loss();
    for (std::size_t i = 0; i < points.size(); ++i)
      state_.ledger.hand += points[i].force.dot(scratch.ways[i]);
    for (std::size_t i = 0; i < passage.holds.size(); ++i) {
      passage.holds[i].s += points[i].slipped;
      passage.holds[i].slip = points[i].slip;
    }
    if (scratch.punctures) puncture(state_.needles[n], scratch);
    passage.pass_end(state_.needles[n].settings.shape);
    for (const EmbeddedPoint& bite : std::exchange(passage.passed, {}))
      state_.bites.push_back({state_.needles[n].tool, bite});
    passage.draw_back();
  }
}

// A force that falls as a surface gives way has stored F²/2k along the needle.
template <class Real>
void Needles<Real>::puncture(Needle& needle, const Scratch& scratch) {
  const NeedleGuide::Point& tip = scratch.guide.points().back();
  const double along = tip.force.dot(tip.along);
  state_.ledger.puncture += along * along / (2 * NeedleGuide::stiffness);
  const bool enters = needle.passage.tip == NeedlePassage::Tip::pushing;
  report(enters ? Event::Kind::punctured : Event::Kind::exited, needle, tip.c, needle.pressed);
  needle.passage.puncture();
}

template <class Real>
void Needles<Real>::report(Event::Kind kind, const Needle& needle, const Vec3d& place, double size) {
  const std::string with = size > 0 ? ", at " + rounded(size) + " N" : "";
  const std::string what = kind == Event::Kind::punctured ? "has gone in" : "has come out";
  state_.events.push_back({kind, time_, place, size, "needle \"" + needle.name + "\" " + what + with});
}

template class Needles<float>;
template class Needles<double>;

}  // namespace lobe
