#include "lobe/contact/self_near.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "lobe/cut/distance.h"

namespace lobe {
namespace {

// By how much the outermost points of a triangle are beyond the plane of a face; NaN if that is flat [m].
double gap_beyond(const Mat34<double>& tet, int face, const Mat3<double>& points) {
  const Vec3d from = tet.col((face + 1) % 4);
  const Vec3d n = (tet.col((face + 2) % 4) - from).cross(tet.col((face + 3) % 4) - from);
  const double length = n.dot(tet.col(face) - from) < 0 ? n.norm() : -n.norm();
  return (n.transpose() * (points.colwise() - from) / length).minCoeff();
}

}  // namespace

Mat34<double> SelfNear::corners_of(const Places& now, int layer) const {
  Mat34<double> x;
  for (int c = 0; c < 4; ++c) x.col(c) = now.of_vertex(rest_.layer(layer).corners[c]);
  return x;
}

// The plane that parted a pair last parts most of them still.
bool SelfNear::is_parted(int pair, const Mat34<double>& tet, const Mat3<double>& points) {
  std::uint8_t& last = faces_[std::size_t(pair)];
  if (gap_beyond(tet, last, points) > rest_.near) return true;
  for (std::uint8_t face = 0; face < 4; ++face) {
    if (!(gap_beyond(tet, face, points) > rest_.near)) continue;
    last = face;
    return true;
  }
  return false;
}

auto SelfNear::inverse(const Mat34<double>& corners, int layer) -> const Inverse& {
  Inverse& own = inverses_[std::size_t(layer)];
  if (own.visit == visit_) return own;
  own.visit = visit_;
  own.origin = corners.col(0);
  const Mat3<double> edges = corners.rightCols<3>().colwise() - corners.col(0);
  own.is_sound = edges.determinant() > 0;
  if (!own.is_sound) return own;
  own.to_weights = edges.inverse();
  own.heights << 1 / own.to_weights.colwise().sum().norm(), own.to_weights.rowwise().norm().cwiseInverse();
  return own;
}

Eigen::Vector4d SelfNear::Inverse::weights(const Vec3d& x) const {
  Eigen::Vector4d b;
  b.tail<3>() = to_weights * (x - origin);
  b[0] = 1 - b.tail<3>().sum();
  return b;
}

// Whether a point of a triangle is in a tetrahedron, or nearly so.
bool SelfNear::is_near(const Mat3<double>& triangle, int divisions, const Mat34<double>& tet, int layer) {
  const Inverse& own = inverse(tet, layer);
  for (const Vec3d& weights : self_point_weights(divisions)) {
    const Vec3d point = triangle * weights;
    if (own.is_sound && own.gap(own.weights(point)) > rest_.near) continue;
    if (distance_to_tet(point, tet) <= rest_.near) return true;
  }
  return false;
}

}  // namespace lobe
