#include "lobe/contact/tool_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lobe {
namespace {

constexpr int few_divisions = 4;  // what all their points take is less than to ask which strips are near

int divisions_of(double longest, double fineness) {
  return std::clamp(static_cast<int>(std::ceil(longest / (fineness / 2))), 2, most_divisions);
}

}  // namespace

ToolContact::ToolContact(int number, const ObstacleSetup& obstacle) : ToolContact(number, obstacle.shape) {
  friction_ = obstacle.friction;
  appears_ = -std::numeric_limits<double>::infinity();
  goes_ = std::numeric_limits<double>::infinity();
  path_ = {{0, obstacle.position, obstacle.orientation}};
}

void ToolContact::begin_frame(const ToolBody& body, double time) {
  if (!path_.empty()) moved_ += moves_until(moved_at_, time);
  moved_at_ = time;
  ahead_until_ = nothing_ahead;
  friction_ = body.friction;
  appears_ = body.appears;
  goes_ = body.goes;
  path_.assign(body.path.begin(), body.path.end());
}

// ---- Search

void ToolContact::look_ahead(double until) {
  ahead_ = moved_ + moves_until(moved_at_, until);
  ahead_until_ = until;
}

bool ToolContact::is_outdated(double time, double body_moved) const {
  if (slack_ < 0) return true;
  if (time <= ahead_until_ && body_moved - body_moved_ + ahead_ <= slack_) return false;
  if (!is_there(time)) return false;
  return body_moved - body_moved_ + moved_ + moves_until(moved_at_, time) > slack_;
}

double ToolContact::gap_to(const Mat3<double>& triangle, const RigidMotion& now) const {
  const Vec3d centre = triangle.rowwise().sum() / 3;
  const double radius = std::sqrt((triangle.colwise() - centre).colwise().squaredNorm().maxCoeff());
  return distance_.at(now.rotation.transpose() * (centre - now.position), now.opening).value - radius -
         distance_.error();
}

void ToolContact::search(const ContactSurface& surface, const Mat3X<double>& x, double time,
                         double body_moved, double ahead) {
  const RigidMotion now = motion_at(path_, time);
  const double margin = 0.5 * surface.mean_edge() + 1.1 * ahead + memory_.held().most();
  std::vector<int>& place_of = scratch_.place_in_search;
  place_of.assign(surface.points().size(), -1);
  points_.clear();
  candidates_.clear();
  scratch_.near.clear();
  double gap = std::numeric_limits<double>::infinity();  // to the nearest triangle that is no candidate
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const ContactSurface::Triangle& triangle = surface.triangles()[t];
    const Vec3d a = x.col(triangle.points[0]), b = x.col(triangle.points[1]), c = x.col(triangle.points[2]);
    const Vec3d centre = (a + b + c) / 3;
    const double radius = std::sqrt(
        std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
    double distance = (centre - now.position).norm() - distance_.reach() - now.opening - radius;
    if (distance <= margin) distance = gap_to(x(Eigen::all, triangle.points), now);
    if (!(distance <= margin)) {
      gap = std::min(gap, distance);
      continue;
    }
    Candidate& found = candidates_.emplace_back();
    found.triangle = static_cast<int>(t);
    found.divisions = divisions_of(triangle.longest, distance_.fineness());
    found.points = triangle.points;
    for (int p : triangle.points) place_of[std::size_t(p)] = 0;
  }
  for (std::size_t p = 0; p < place_of.size(); ++p) {  // in the order of the surface, as sums go over them
    if (place_of[p] < 0) continue;
    place_of[p] = static_cast<int>(points_.size());
    points_.push_back(static_cast<int>(p));
  }
  for (Candidate& candidate : candidates_)
    for (int& p : candidate.points) p = place_of[std::size_t(p)];
  scratch_.triangles.clear();
  for (const Candidate& candidate : candidates_) {
    const ContactSurface::Triangle& triangle = surface.triangles()[std::size_t(candidate.triangle)];
    const int n = candidate.divisions;
    scratch_.triangles.push_back({.stiffness = triangle.stiffness, .area = triangle.area / (n * n)});
  }
  slack_ = candidates_.empty() ? gap : margin;
  moved_ = 0;
  moved_at_ = time;
  ahead_until_ = nothing_ahead;
  body_moved_ = body_moved;
}

// ---- What is touched

// Finds the candidates that are not known to be out of reach. False: there are none.
bool ToolContact::find_near(const At& at) {
  scratch_.near.clear();
  const bool knows = at.time <= ahead_until_;
  const double moved = at.body_moved + ahead_ + memory_.held().most();
  for (std::size_t c = 0; c < candidates_.size(); ++c)
    if (!knows || moved >= candidates_[c].clear_until) scratch_.near.push_back(static_cast<int>(c));
  return !scratch_.near.empty();
}

void ToolContact::find_touches(const At& at, const RigidMotion& now) {
  find_places(at, now);
  scratch_.block_count = 0;
  for (int c : scratch_.near) take_triangle(c, now);
  find_distances(0, now);
  if (memory_.held().any()) leave_what_is_held(at);
  remember_clear(at, now);
}

// Speeds against the tool are linear within a triangle, since it is rigid.
void ToolContact::find_places(const At& at, const RigidMotion& now) {
  constexpr int width = PointBlock::width;
  const auto room = (Eigen::Index(points_.size()) + width - 1) / width * width;
  if (scratch_.places.cols() < room)
    for (PointRows* of_points : {&scratch_.places, &scratch_.speeds}) of_points->setZero(3, room);
  scratch_.place_of.resize(points_.size());
  scratch_.evaluation_of.resize(points_.size(), 0);
  scratch_.points.clear();
  ++scratch_.number;
  for (int c : scratch_.near) {
    TouchTriangle& triangle = scratch_.triangles[std::size_t(c)];
    for (int i = 0; i < 3; ++i) {
      const auto p = std::size_t(candidates_[std::size_t(c)].points[i]);
      if (std::exchange(scratch_.evaluation_of[p], scratch_.number) != scratch_.number) {
        scratch_.place_of[p] = int(scratch_.points.size());
        scratch_.points.push_back(points_[p]);
      }
      triangle.points[std::size_t(i)] = scratch_.place_of[p];
    }
  }
  at.places.of_points(scratch_.points, scratch_.places, scratch_.speeds);
  const Vec3d spin = now.rotation.transpose() * now.spin;
  TouchAxes axes;
  for (int d = 0; d < 3; ++d) {
    const auto i = std::size_t(d);
    axes.to_tool[i] = {now.rotation(0, d), now.rotation(1, d), now.rotation(2, d)};
    axes.position[i] = now.position[d];
    axes.velocity[i] = now.velocity[d];
    axes.spin[i] = spin[d];
  }
  kernels_.to_axes(axes, rows(scratch_.places), rows(scratch_.speeds), int(scratch_.points.size()));
}

void ToolContact::take_triangle(int number, const RigidMotion& now) {
  TouchTriangle& triangle = scratch_.triangles[std::size_t(number)];
  const int n = candidates_[std::size_t(number)].divisions;
  for (int d = 0; d < 3; ++d) {
    const auto i = std::size_t(d);
    const auto x = [&](std::size_t c) { return scratch_.places(d, triangle.points[c]); };
    triangle.along[i] = (x(1) - x(0)) / n;
    triangle.up[i] = (x(2) - x(0)) / n;
    triangle.turn[i] = (triangle.along[i] + triangle.up[i]) / 3;
    triangle.start[i] = x(0) + triangle.turn[i];
  }
  if (n <= few_divisions)
    take_blocks(number, n, 0, int(point_blocks(n).size()));
  else
    take_near_strips(number, n, now);
}

// Blocks of points of a triangle.
void ToolContact::take_blocks(int triangle, int divisions, int begin, int end) {
  const std::vector<PointBlock>& points = point_blocks(divisions);
  const std::size_t count = scratch_.block_count + std::size_t(end - begin);
  if (scratch_.blocks.size() < count) scratch_.blocks.resize(count);
  for (int b = begin; b < end; ++b) {
    TouchBlock& block = scratch_.blocks[scratch_.block_count++];
    block.points = &points[std::size_t(b)];
    block.triangle = triangle;
    block.first = b * PointBlock::width;
  }
}

// Those of strips that may be touched.
void ToolContact::take_near_strips(int number, int n, const RigidMotion& now) {
  const TouchTriangle& triangle = scratch_.triangles[std::size_t(number)];
  constexpr int width = PointBlock::width;
  const double more = memory_.held().most() + distance_.error();
  const auto is_beyond = [&](const Vec3d& middle, double radius) {
    return distance_.is_beyond(middle, radius + more, now.opening);
  };
  const auto vector = [](const std::array<double, 3>& a) { return Vec3d(a[0], a[1], a[2]); };
  const Vec3d along = vector(triangle.along), up = vector(triangle.up), start = vector(triangle.start);
  const double length = along.norm(), height = vector(triangle.turn).norm();
  const Vec3d centre = start + (n - 1) * (along + up) / 3;
  if (is_beyond(centre, 2.0 / 3 * n * std::max({length, up.norm(), (along - up).norm()}))) return;
  for (int j = 0, end = 0; j < n; ++j) {
    const int last = n - j - 1;
    if (is_beyond(start + j * up + 0.5 * last * along, 0.5 * last * length + height)) continue;
    const int begin = std::max(end, strip(n, j).begin / width);
    end = std::max(end, (strip(n, j).end + width - 1) / width);
    take_blocks(number, n, begin, end);
  }
}

// A mesh has a grid in place of a formula.
void ToolContact::find_distances(std::size_t first, const RigidMotion& now) {
  const double near = memory_.held().most();
  kernels_.find_distances(touch_shape(now), near, scratch_.triangles.data(), scratch_.blocks.data() + first,
                          int(scratch_.block_count - first));
  if (shape_.kind != RigidShape::Kind::mesh) return;
  for (std::size_t b = first; b < scratch_.block_count; ++b)
    for (unsigned int rest = scratch_.blocks[b].points->lanes; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      const Distance found = distance_.at(lane_of(scratch_.blocks[b].place, lane));
      scratch_.blocks[b].distance[lane] = found.value;
      for (std::size_t d = 0; d < 3; ++d) scratch_.blocks[b].gradient[d][lane] = found.gradient[int(d)];
      if (found.value < near) scratch_.blocks[b].touched |= 1u << lane;
    }
}

// Of points near enough for what is held somewhere, leaves those that are for what is held there.
void ToolContact::leave_what_is_held(const At& at) {
  visit_lanes([&](TouchBlock& block, std::size_t lane) {
    block.held[lane] = memory_.held().at(triangle_of(block, at).points, lane_of(block.points->weights, lane));
    if (block.distance[lane] >= block.held[lane]) block.touched &= ~(1u << lane);
  });
}

// Until when those are clear that nothing touches now. The tool moves by no more than ahead_ − moved_ from
// the start of the frame to its end, and no point of a triangle by more than its corners. What is clear by
// less than `least` is not safe from changes that no step makes.
void ToolContact::remember_clear(const At& at, const RigidMotion& now) {
  constexpr double least = 1e-5;  // [m]
  std::size_t b = 0;
  for (int t : scratch_.near) {
    Candidate& candidate = candidates_[std::size_t(t)];
    const std::size_t begin = b;
    unsigned int touched = 0;
    for (; b < scratch_.block_count && scratch_.blocks[b].triangle == t; ++b)
      touched |= scratch_.blocks[b].touched;
    if (touched != 0) continue;
    double gap = std::numeric_limits<double>::infinity();
    const auto see = [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        for (unsigned int rest = scratch_.blocks[i].points->lanes; rest != 0; rest &= rest - 1)
          gap = std::min(gap, scratch_.blocks[i].distance[std::size_t(std::countr_zero(rest))]);
    };
    if (candidate.divisions <= few_divisions) {
      see(begin, b);
    } else {  // all strips
      const std::size_t count = scratch_.block_count;
      take_blocks(t, candidate.divisions, 0, int(point_blocks(candidate.divisions).size()));
      find_distances(count, now);
      see(count, scratch_.block_count);
      scratch_.block_count = count;
    }
    candidate.clear_until = at.body_moved + moved_ + gap - distance_.error() - least;
  }
}

// ---- Forces

void ToolContact::find_forces(const At& at) {
  on_tool_ = {.tool = tool_};
  scratch_.pressed.clear();
  if (!is_there(at.time) || !find_near(at)) return;
  const RigidMotion now = motion_at(path_, at.time);
  find_touches(at, now);
  begin_forces();
  if (friction_ > 0) find_anchors(at);
  const double grip =
      kernels_.add_forces(law(at), touch_shape(now), scratch_.triangles.data(), scratch_.blocks.data(),
                          int(scratch_.block_count), rows(scratch_.speeds), scratch_.forces.data());
  remember(at);
  turn_and_sum(now.rotation);
  if (shape_.kind == RigidShape::Kind::jaws) on_tool_.grip = std::max(0.0, grip);
}

// The corners of the triangles that are touched, and no forces on them.
void ToolContact::begin_forces() {
  if (scratch_.forces.cols() < scratch_.places.cols()) scratch_.forces.resize(4, scratch_.places.cols());
  scratch_.is_pressed.assign(scratch_.points.size(), 0);
  for (std::size_t b = 0; b < scratch_.block_count; ++b) {
    if (scratch_.blocks[b].touched == 0) continue;
    for (int p : scratch_.triangles[std::size_t(scratch_.blocks[b].triangle)].points) {
      if (std::exchange(scratch_.is_pressed[std::size_t(p)], 1)) continue;
      scratch_.pressed.push_back(p);
      scratch_.forces.col(p).setZero();
    }
  }
}

void ToolContact::find_anchors(const At& at) {
  AnchorReader anchors = memory_.anchors();
  visit_lanes([&](TouchBlock& block, std::size_t lane) {
    const Anchor* anchor =
        anchors.find(triangle_of(block, at).owner, candidate_of(block).divisions, block.first + int(lane));
    block.has_anchor[lane] = anchor != nullptr;
    if (!anchor) return;
    for (std::size_t d = 0; d < 3; ++d) block.anchor[d][lane] = anchor->at[int(d)];
  });
}

// What a step would leave behind.
void ToolContact::remember(const At& at) {
  if (friction_ > 0)
    visit_lanes([&](const TouchBlock& block, std::size_t lane) {
      const FaceOwner& owner = triangle_of(block, at).owner;
      memory_.add({.tet = owner.tet,
                   .code = owner.code,
                   .divisions = candidate_of(block).divisions,
                   .number = block.first + int(lane),
                   .at = lane_of(block.anchor, lane)});
    });
  if (at.law.hold > 0)
    visit_lanes([&](const TouchBlock& block, std::size_t lane) {
      const TouchTriangle& triangle = scratch_.triangles[std::size_t(block.triangle)];
      memory_.held().add(candidate_of(block).triangle, triangle_of(block, at).points,
                         lane_of(block.points->weights, lane), triangle.area * triangle.stiffness,
                         -block.distance[lane]);
    });
  memory_.held().end(at.surface, at.law, at.since);
}

// Turns forces from the tool's axes to those of the world, and sums them and their torque about its origin.
void ToolContact::turn_and_sum(const Mat3<double>& rotation) {
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  for (int p : scratch_.pressed) {
    const Vec3d own = scratch_.forces.col(p).head<3>(), place = scratch_.places.col(p);
    force += own;
    torque += place.cross(own);
    scratch_.forces.col(p).head<3>() = rotation * own;
  }
  on_tool_.force = rotation * force;
  on_tool_.torque = rotation * torque;
}

double ToolContact::energy(const At& at) {
  if (!is_there(at.time) || !find_near(at)) return 0;
  const ContactLaw own = law(at);
  const bool is_unit = shape_.kind != RigidShape::Kind::mesh;
  double sum = 0;
  visit_touches(at, motion_at(path_, at.time), [&](const Candidate&, const Touch& touch) {
    const double stiffness = touch.triangle.stiffness, area = touch.triangle.area;
    sum += area * own.energy(touch.depth, touch.held, stiffness);
    if (friction_ == 0 || !touch.anchor) return;
    const double pressure = own.pressure(touch.depth, touch.held, stiffness);
    const Vec3d way = touch.place - touch.anchor->at;
    const Vec3d slip = held_slip(own, stiffness, way, touch.gradient, is_unit, pressure);
    sum += area * ContactLaw::slip_share * stiffness / 2 * slip.squaredNorm();
  });
  return sum;
}

}  // namespace lobe
