#include "lobe/live/pose_filter.h"

#include <cmath>

namespace lobe {
namespace {

// Of a critically damped spring, x'' = ω² (target − x) − 2 ω x', solved exactly over dt: by how much x moves.
// It trails a target that moves uniformly by 2/ω.
Vec3d way(const Vec3d& gap, Vec3d& velocity, double dt, double lag, double top) {
  const double omega = 2 / lag, decay = std::exp(-omega * dt);
  const Vec3d slope = velocity - omega * gap;
  Vec3d moved = gap + (slope * dt - gap) * decay;
  velocity = (velocity - omega * dt * slope) * decay;
  if (const double length = moved.norm(); length > top * dt) {
    moved *= top * dt / length;
    velocity = moved / dt;
  }
  return moved;
}

Vec3d rotation_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q);
  return turn.angle() * turn.axis();
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& from, const Vec3d& by) {
  const double angle = by.norm();
  if (angle == 0) return from;
  return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, by / angle)) * from).normalized();
}

}  // namespace

bool PoseFilter::step(double dt, const HandLimits& limits) {
  constexpr double near = 1e-7, slow = 1e-5;  // [m], [rad], and per second
  const Eigen::Quaterniond from(now_.orientation), to(target_.orientation);
  const Vec3d gap = target_.position - now_.position, turn = rotation_vector(to * from.conjugate());
  if (gap.norm() < near && turn.norm() < near && velocity_.norm() < slow && spin_.norm() < slow) return false;
  now_.position += way(gap, velocity_, dt, limits.lag, limits.top_speed);
  now_.orientation = turned(from, way(turn, spin_, dt, limits.lag, limits.top_turn)).coeffs();
  return true;
}

bool PoseFilter::step_without_lag(double dt, const HandLimits& limits) {
  const Eigen::Quaterniond from(now_.orientation), to(target_.orientation);
  Vec3d way = target_.position - now_.position, turn = rotation_vector(to * from.conjugate());
  if (way.isZero(0) && turn.isZero(0)) return false;
  if (const double length = way.norm(); length > limits.top_speed * dt) way *= limits.top_speed * dt / length;
  if (const double angle = turn.norm(); angle > limits.top_turn * dt) turn *= limits.top_turn * dt / angle;
  now_.position += way;
  now_.orientation = turned(from, turn).coeffs();
  velocity_ = way / dt;
  spin_ = turn / dt;
  return true;
}

}  // namespace lobe
