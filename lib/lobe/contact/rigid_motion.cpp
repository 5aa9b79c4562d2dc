#include "lobe/contact/rigid_motion.h"

#include <Eigen/Geometry>
#include <cmath>

namespace lobe {
namespace {

constexpr double moment = velocity_moment;

double angle_between(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  return Eigen::Quaterniond(a).angularDistance(Eigen::Quaterniond(b));
}

}  // namespace

RigidMotion motion_at(const std::vector<PathPoint>& path, double time) {
  RigidMotion motion;
  motion.position = path_at(path, time);
  const Eigen::Vector4d orientation = orientation_at(path, time);
  motion.rotation = Eigen::Quaterniond(orientation).normalized().toRotationMatrix();
  motion.opening = opening_at(path, time);
  if (path.size() < 2 || time > path.back().time + moment) return motion;
  motion.opens = (motion.opening - opening_at(path, time - moment)) / moment;
  motion.velocity = (motion.position - path_at(path, time - moment)) / moment;
  const Eigen::Vector4d before = orientation_at(path, time - moment);
  if (before == orientation) return motion;
  const Eigen::Quaterniond change = Eigen::Quaterniond(orientation) * Eigen::Quaterniond(before).conjugate();
  motion.spin = (change.w() < 0 ? -2.0 : 2.0) * change.vec() / moment;
  return motion;
}

// A point moves with the position, by the angle about it, and with jaws. Rows in between can only add to
// that.
double farthest_move(const std::vector<PathPoint>& path, double from, double to, double reach) {
  double sum = 0;
  PathPoint last{from, path_at(path, from), orientation_at(path, from), opening_at(path, from)};
  const auto add = [&](const PathPoint& row) {
    sum += (row.position - last.position).norm() + std::abs(row.opening - last.opening);
    if (row.orientation != last.orientation) sum += reach * angle_between(row.orientation, last.orientation);
    last = row;
  };
  for (auto row = after(path, from); row != path.end() && row->time < to; ++row) add(*row);
  add({to, path_at(path, to), orientation_at(path, to), opening_at(path, to)});
  return sum;
}

}  // namespace lobe
