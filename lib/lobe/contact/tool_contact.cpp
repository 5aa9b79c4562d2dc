#include "lobe/contact/tool_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  friction_ = body.friction;
  appears_ = body.appears;
  goes_ = body.goes;
  path_.assign(body.path.begin(), body.path.end());
}

// ---- Search

bool ToolContact::is_outdated(double time, double body_moved) const {
  if (slack_ < 0) return true;
  if (!is_there(time)) return false;
  return body_moved - body_moved_ + moved_ + moves_until(moved_at_, time) > slack_;
}

double ToolContact::gap_to(const Mat3<double>& triangle, const RigidMotion& now) const {
  const Vec3d centre = triangle.rowwise().sum() / 3;
  const double radius = std::sqrt((triangle.colwise() - centre).colwise().squaredNorm().maxCoeff());
  return distance_.at(now.turn.transpose() * (centre - now.position), now.opening).value - radius -
         distance_.error();
}

void ToolContact::search(const ContactSurface& surface, const Mat3X<double>& x, double time,
                         double body_moved, double ahead) {
  const RigidMotion now = motion_at(path_, time);
  const double margin = 0.2 * surface.mean_edge() + 1.1 * ahead;
  place_of_.assign(surface.points().size(), -1);
  points_.clear();
  candidates_.clear();
  double gap = std::numeric_limits<double>::infinity();  // to the nearest triangle that is no candidate
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const ContactSurface::Triangle& own = surface.triangles()[t];
    const Vec3d a = x.col(own.points[0]), b = x.col(own.points[1]), c = x.col(own.points[2]);
    const Vec3d centre = (a + b + c) / 3;
    const double radius = std::sqrt(
        std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
    double distance = (centre - now.position).norm() - distance_.reach() - now.opening - radius;
    if (distance <= margin) distance = gap_to(x(Eigen::all, own.points), now);
    if (!(distance <= margin)) {
      gap = std::min(gap, distance);
      continue;
    }
    Candidate& found = candidates_.emplace_back();
    found.triangle = static_cast<int>(t);
    found.divisions = divisions_of(own.longest, distance_.fineness());
    found.points = own.points;
    for (int p : own.points) place_of_[std::size_t(p)] = 0;
  }
  for (std::size_t p = 0; p < place_of_.size(); ++p) {  // in the order of the surface, as sums go over them
    if (place_of_[p] < 0) continue;
    place_of_[p] = static_cast<int>(points_.size());
    points_.push_back(static_cast<int>(p));
  }
  for (Candidate& own : candidates_)
    for (int& p : own.points) p = place_of_[std::size_t(p)];
  slack_ = candidates_.empty() ? gap : margin;
  moved_ = 0;
  moved_at_ = time;
  body_moved_ = body_moved;
  if (friction_ == 0) return;
  std::swap(anchors_, next_);
  anchors_.clear();
  for (Candidate& own : candidates_)
    own.first = anchors_.add(surface.triangles()[std::size_t(own.triangle)].owner, own.divisions);
  anchors_.take_over(next_);
  next_ = anchors_;
}

// ---- Forces

// Per area [Pa], in the tool's axes; `anchors` takes where its anchor is then.
Vec3d ToolContact::friction_of(const Touch& touch, double stiffness, double pressure,
                               Anchors& anchors) const {
  const auto i = std::size_t(touch.anchor);
  const Vec3d anchor = anchors_.holds[i] ? anchors_.at[i] : touch.place;
  const Vec3d n = touch.gradient.normalized(), way = touch.place - anchor;
  Vec3d slip = way - n * n.dot(way);
  const double force = stiffness / 2 * slip.norm(), most = friction_ * pressure;
  if (force > most) slip *= most / force;
  anchors.holds[i] = 1;
  anchors.at[i] = touch.place - slip;
  return -stiffness / 2 * slip;
}

void ToolContact::add_forces(const At& at, Mat3X<double>& f) {
  on_tool_ = {.tool = tool_};
  next_.let_go();
  if (!is_there(at.time) || candidates_.empty()) return;
  const RigidMotion now = motion_at(path_, at.time);
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  double grip = 0;
  visit_touches(at, now, [&](const Candidate& own, const Touch& touch) {
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(own.triangle)];
    const double area = triangle.area / (own.divisions * own.divisions);
    double pressure = at.law.pressure(touch.depth, triangle.stiffness);
    if (at.law.damping > 0) {
      Vec3d v = Vec3d::Zero();
      for (int c = 0; c < 3; ++c) v += touch.weights[c] * at.v.col(own.points[c]);
      v -= now.velocity + now.spin.cross(now.turn * touch.place);
      const double approach = -touch.gradient.dot(now.turn.transpose() * v) +
                              touch.gradient.y() * std::copysign(now.opens / 2, touch.place.y());
      pressure = std::max(0.0, pressure + at.law.damping * triangle.stiffness * approach);
    }
    Vec3d traction = pressure * touch.gradient;
    if (friction_ > 0) traction += friction_of(touch, triangle.stiffness, pressure, next_);
    const Vec3d own_force = area * traction, in_world = now.turn * own_force;
    for (int c = 0; c < 3; ++c) f.col(own.points[c]) += touch.weights[c] * in_world;
    force += own_force;
    torque += touch.place.cross(own_force);
    grip -= std::copysign(0.5, touch.place.y()) * own_force.y();
  });
  on_tool_.force = now.turn * force;
  on_tool_.torque = now.turn * torque;
  if (shape_.kind == RigidShape::Kind::jaws) on_tool_.grip = std::max(0.0, grip);
}

double ToolContact::energy(const At& at) const {
  if (!is_there(at.time)) return 0;
  double sum = 0;
  Anchors unused = next_;
  visit_touches(at, motion_at(path_, at.time), [&](const Candidate& own, const Touch& touch) {
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(own.triangle)];
    const double area = triangle.area / (own.divisions * own.divisions);
    const double pressure = at.law.pressure(touch.depth, triangle.stiffness);
    const double linear = std::min(touch.depth, at.law.deepest);
    sum += area * pressure * (touch.depth - linear / 2);
    if (friction_ > 0)
      sum +=
          area * friction_of(touch, triangle.stiffness, pressure, unused).squaredNorm() / triangle.stiffness;
  });
  return sum;
}

// ---- Anchors

void ToolContact::end_step() { std::swap(anchors_, next_); }

// Its triangles need not be the candidates of now: they are searched anew.
void ToolContact::use_kept() {
  anchors_ = kept_;
  next_ = kept_;
  forget();
}

}  // namespace lobe
