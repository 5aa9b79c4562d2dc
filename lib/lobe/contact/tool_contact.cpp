#include "lobe/contact/tool_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace lobe {
namespace {

constexpr int most_divisions = 24;

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
  place_of_.assign(surface.points().size(), -1);
  points_.clear();
  candidates_.clear();
  near_.clear();
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
    for (int p : triangle.points) place_of_[std::size_t(p)] = 0;
  }
  for (std::size_t p = 0; p < place_of_.size(); ++p) {  // in the order of the surface, as sums go over them
    if (place_of_[p] < 0) continue;
    place_of_[p] = static_cast<int>(points_.size());
    points_.push_back(static_cast<int>(p));
  }
  for (Candidate& candidate : candidates_)
    for (int& p : candidate.points) p = place_of_[std::size_t(p)];
  slack_ = candidates_.empty() ? gap : margin;
  moved_ = 0;
  moved_at_ = time;
  ahead_until_ = nothing_ahead;
  body_moved_ = body_moved;
}

// ---- Forces

// Finds the candidates that are not known to be out of reach. False: there are none.
bool ToolContact::find_near(const At& at) const {
  near_.clear();
  const bool knows = at.time <= ahead_until_;
  const double moved = at.body_moved + ahead_ + memory_.held().most();
  for (std::size_t c = 0; c < candidates_.size(); ++c)
    if (!knows || moved >= candidates_[c].clear_until) near_.push_back(static_cast<int>(c));
  return !near_.empty();
}

void ToolContact::find_places(const At& at, const RigidMotion& now) const {
  if (places_.cols() < Eigen::Index(points_.size())) places_.resize(3, Eigen::Index(points_.size()));
  place_is_of_.resize(points_.size(), 0);
  ++evaluation_;
  const Mat3<double> to_tool = now.rotation.transpose();
  for (int c : near_)
    for (int p : candidates_[std::size_t(c)].points) {
      if (std::exchange(place_is_of_[std::size_t(p)], evaluation_) == evaluation_) continue;
      places_.col(p) = to_tool * (at.places.of_point(points_[std::size_t(p)]) - now.position);
    }
}

// The tool moves by no more than ahead_ − moved_ from the start of the frame to its end, and no point of a
// triangle by more than its corners. What is clear by less than `least` is not safe from changes that no step
// makes.
void ToolContact::remember_clear(const Candidate& candidate, const Mat3<double>& x, const At& at,
                                 double opening) const {
  constexpr double least = 1e-5;  // [m]
  double gap = std::numeric_limits<double>::infinity();
  visit_places(
      x, candidate.divisions, [](const Vec3d&, double) { return false; },
      [&](int, const Vec3d& place, auto&&) { gap = std::min(gap, distance_.at(place, opening).value); });
  candidate.clear_until = at.body_moved + moved_ + gap - distance_.error() - least;
}

// The tangential way from the anchor, which has followed where it slides, to the point [m].
Vec3d ToolContact::slip_of(const Touch& touch, double stiffness, double pressure) const {
  if (!touch.anchor) return Vec3d::Zero();
  const Vec3d &g = touch.gradient, way = touch.place - touch.anchor->at;
  const double square_of_g = distance_.error() > 0 ? g.squaredNorm() : 1;  // of a mesh g is no unit vector
  const Vec3d slip = way - g * (g.dot(way) / square_of_g);
  const double square = stiffness * stiffness / 4 * slip.squaredNorm(), most = friction_ * pressure;
  return square > most * most ? Vec3d(slip * (most / std::sqrt(square))) : slip;
}

// Turns forces at these points from the tool's axes to those of the world. Returns their sum and their torque
// about the tool's origin.
static std::pair<Vec3d, Vec3d> turn_and_sum(const std::vector<int>& points, const Mat3X<double>& places,
                                            const Mat3<double>& rotation, Mat3X<double>& f) {
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  for (int p : points) {
    const Vec3d own = f.col(p);
    force += own;
    torque += places.col(p).cross(own);
    f.col(p) = rotation * own;
  }
  return {rotation * force, rotation * torque};
}

void ToolContact::find_forces(const At& at, Mat3X<double>& f) {
  on_tool_ = {.tool = tool_};
  pressed_.clear();
  if (!is_there(at.time) || !find_near(at)) return;
  const RigidMotion now = motion_at(path_, at.time);
  const auto count = Eigen::Index(points_.size());
  if (speeds_.cols() < count) speeds_.resize(3, count);
  is_pressed_in_.resize(points_.size(), 0);
  double grip = 0;
  // All in the tool's axes. Speeds against the tool are linear within a triangle, since it is rigid.
  const Mat3<double> to_tool = now.rotation.transpose();
  const Vec3d spin = to_tool * now.spin;
  const auto begin_point = [&](int p) {
    if (std::exchange(is_pressed_in_[std::size_t(p)], evaluation_) == evaluation_) return;
    pressed_.push_back(p);
    f.col(p).setZero();
    if (at.law.damping == 0) return;
    const Vec3d v = at.places.velocity_of_point(points_[std::size_t(p)]) - now.velocity;
    speeds_.col(p) = to_tool * v - spin.cross(places_.col(p));
  };
  const Candidate* of = nullptr;
  double stiffness = 0, area = 0;  // of the candidate, and of each of its points
  const bool has_jaws = shape_.kind == RigidShape::Kind::jaws;
  visit_touches(at, now, [&](const Candidate& candidate, const Touch& touch) {
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(candidate.triangle)];
    if (std::exchange(of, &candidate) != &candidate) {
      for (int p : candidate.points) begin_point(p);
      stiffness = triangle.stiffness;
      area = triangle.area / (candidate.divisions * candidate.divisions);
    }
    double pressure = at.law.pressure(touch.depth, touch.held, stiffness);
    if (at.law.damping > 0) {
      double approach = has_jaws ? touch.gradient.y() * std::copysign(now.opens / 2, touch.place.y()) : 0;
      for (int c = 0; c < 3; ++c)
        approach -= touch.weights[c] * touch.gradient.dot(speeds_.col(candidate.points[c]));
      pressure = std::max(0.0, pressure + at.law.damping * stiffness * approach);
    }
    Vec3d traction = pressure * touch.gradient;
    if (friction_ > 0) {
      const Vec3d slip = slip_of(touch, stiffness, pressure);
      traction -= stiffness / 2 * slip;
      memory_.add({.tet = triangle.owner.tet,
                   .code = triangle.owner.code,
                   .divisions = candidate.divisions,
                   .number = touch.number,
                   .at = touch.place - slip});
    }
    if (at.law.hold > 0)
      memory_.held().add(candidate.triangle, triangle.points, touch.weights, area * stiffness, touch.depth);
    const Vec3d own_force = area * traction;
    for (int c = 0; c < 3; ++c) f.col(candidate.points[c]) += touch.weights[c] * own_force;
    if (has_jaws) grip -= std::copysign(0.5, touch.place.y()) * own_force.y();
  });
  memory_.held().end(at.surface, at.law, at.since);
  std::tie(on_tool_.force, on_tool_.torque) = turn_and_sum(pressed_, places_, now.rotation, f);
  if (has_jaws) on_tool_.grip = std::max(0.0, grip);
}

double ToolContact::energy(const At& at) const {
  if (!is_there(at.time) || !find_near(at)) return 0;
  double sum = 0;
  visit_touches(at, motion_at(path_, at.time), [&](const Candidate& candidate, const Touch& touch) {
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(candidate.triangle)];
    const double area = triangle.area / (candidate.divisions * candidate.divisions);
    sum += area * at.law.energy(touch.depth, touch.held, triangle.stiffness);
    if (friction_ == 0) return;
    const double pressure = at.law.pressure(touch.depth, touch.held, triangle.stiffness);
    sum += area * triangle.stiffness / 4 * slip_of(touch, triangle.stiffness, pressure).squaredNorm();
  });
  return sum;
}

}  // namespace lobe
