#include "lobe/contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/cut/distance.h"

namespace lobe {

namespace {

// A point on a face is behind it, whatever rounding says: to take another face for it would be to take it for
// deep [m].
constexpr double just_behind = 1e-12;

}  // namespace

// ---- Where the two overlap

// The face of the boundary that is nearest at rest to a point of a tetrahedron, of those that it lies behind;
// −1: none.
int SelfContact::face_at(const Layer& layer, const Vec3d& rest) const {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = layer.first; i < layer.first + layer.count; ++i) {
    const int f = faces_[std::size_t(i)];
    const Plane& plane = planes_[std::size_t(f)];
    const double g = plane.normal.dot(rest - plane.corner);
    if (g > just_behind || g * g >= least) continue;  // it is no nearer than its plane
    const Mat3<double>& X = rest_[std::size_t(f)];
    const double square = (rest - nearest_on_triangle(rest, X.col(0), X.col(1), X.col(2))).squaredNorm();
    if (square >= least) continue;
    least = square;
    nearest = f;
  }
  return nearest;
}

auto SelfContact::inverse(const At& at, int unique) -> const Inverse& {
  Inverse& own = inverses_[std::size_t(unique)];
  if (own.pass == pass_) return own;
  own.pass = pass_;
  const Eigen::Vector4i& v = unique_[std::size_t(unique)].corners;
  own.origin = at.of_mesh.col(v[0]);
  Mat3<double> edges;
  for (int c = 0; c < 3; ++c) edges.col(c) = at.of_mesh.col(v[c + 1]) - own.origin;
  own.is_sound = edges.determinant() > 0;
  if (own.is_sound) own.to_weights = edges.inverse();
  return own;
}

// The first of the candidate's tetrahedra that a point is in, and its barycentric coordinates there; −1:
// none. The one that it was in last is tried before, and is the only one but where the point is on a face.
int SelfContact::find_tet(const At& at, const Candidate& own, const Vec3d& x, int last, Eigen::Vector4d& b) {
  const auto is_in = [&](int i, double least) {
    const Inverse& now = inverse(at, unique_of_[std::size_t(i)]);
    if (!now.is_sound) return false;
    b.tail<3>() = now.to_weights * (x - now.origin);
    b[0] = 1 - b.tail<3>().sum();
    return b.minCoeff() >= least;
  };
  if (last >= 0 && is_in(last, 1e-9)) return last;
  for (int i = own.first; i < own.first + own.count; ++i)
    if (is_in(i, 0)) return i;
  return -1;
}

bool SelfContact::find_touch(const At& at, const Candidate& own, const Vec3d& weights, int number,
                             Touch& touch) {
  const Vec3d x = weights[0] * at.x.col(own.points[0]) + weights[1] * at.x.col(own.points[1]) +
                  weights[2] * at.x.col(own.points[2]);
  int& last = last_[std::size_t(&own - candidates_.data()) * points_per_triangle + std::size_t(number)];
  const int i = last = find_tet(at, own, x, last, touch.corner_weights);
  if (i < 0) return false;
  const Layer& layer = layers_[std::size_t(tets_[std::size_t(i)].layer)];
  const int face = face_at(layer, layer.rest * touch.corner_weights);
  if (face < 0) return false;
  const ContactSurface::Triangle& other = at.surface.triangles()[std::size_t(face)];
  Mat3<double> y;
  for (int c = 0; c < 3; ++c) {
    touch.face_points[c] = place_of_[std::size_t(other.points[c])];
    y.col(c) = at.x.col(touch.face_points[c]);
  }
  const Vec3d n = (y.col(1) - y.col(0)).cross(y.col(2) - y.col(0));
  const double square = n.squaredNorm();
  if (!(square > 0)) return false;
  touch.normal = n / std::sqrt(square);
  touch.depth = -touch.normal.dot(x - y.col(0));
  if (!(touch.depth > 0)) return false;
  const Vec3d foot = x + touch.depth * touch.normal;
  touch.face_weights[1] = (y.col(2) - y.col(0)).cross(foot - y.col(0)).dot(n) / -square;
  touch.face_weights[2] = (y.col(1) - y.col(0)).cross(foot - y.col(0)).dot(n) / square;
  touch.face_weights[0] = 1 - touch.face_weights[1] - touch.face_weights[2];
  const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(own.triangle)];
  const double a = at.surface.self_stiffness(own.triangle), c = at.surface.self_stiffness(face);
  touch.stiffness = a + c > 0 ? a * c / (a + c) / 2 : 0;
  touch.area = triangle.area / points_per_triangle;
  touch.candidate = &own;
  touch.weights = weights;
  touch.face = face;
  touch.corners = unique_[std::size_t(unique_of_[std::size_t(i)])].corners;
  return true;
}

// ---- Forces

// Per area, on the point [Pa]; `next_` takes ξ.
Vec3d SelfContact::friction_of(const At& at, const Touch& touch, double pressure) {
  const auto i = std::size_t(touch.anchor);
  Vec3d slip = Vec3d::Zero();
  if (anchors_.holds[i]) {
    const Vec3d speed = at.v(Eigen::all, touch.candidate->points) * touch.weights -
                        at.v_of_mesh(Eigen::all, touch.corners) * touch.corner_weights;
    slip = anchors_.at[i] + at.since * speed;
    slip -= touch.normal * touch.normal.dot(slip);
  }
  const double force = touch.stiffness / 2 * slip.norm(), most = friction_ * pressure;
  if (force > most) slip *= most / force;
  next_.holds[i] = 1;
  next_.at[i] = slip;
  return -touch.stiffness / 2 * slip;
}

void SelfContact::add_forces(const At& at, Mat3X<double>& f, Mat3X<double>& f_of_mesh) {
  next_.let_go();
  visit_touches(at, [&](const Touch& touch) {
    double pressure = at.law.pressure(touch.depth, touch.stiffness);
    if (at.law.damping > 0) {
      const Vec3d speed = at.v(Eigen::all, touch.candidate->points) * touch.weights -
                          at.v(Eigen::all, touch.face_points) * touch.face_weights;
      pressure = std::max(0.0, pressure - at.law.damping * touch.stiffness * touch.normal.dot(speed));
    }
    const Vec3d pushed = touch.area * pressure * touch.normal;
    for (int c = 0; c < 3; ++c) {
      f.col(touch.candidate->points[c]) += touch.weights[c] * pushed;
      f.col(touch.face_points[c]) -= touch.face_weights[c] * pushed;
    }
    if (friction_ == 0) return;
    const Vec3d rubbed = touch.area * friction_of(at, touch, pressure);
    for (int c = 0; c < 3; ++c) f.col(touch.candidate->points[c]) += touch.weights[c] * rubbed;
    for (int c = 0; c < 4; ++c) f_of_mesh.col(touch.corners[c]) -= touch.corner_weights[c] * rubbed;
  });
}

double SelfContact::energy(const At& at) {
  double sum = 0;
  visit_touches(at, [&](const Touch& touch) {
    const double linear = std::min(touch.depth, at.law.deepest);
    sum += touch.area * at.law.pressure(touch.depth, touch.stiffness) * (touch.depth - linear / 2);
    if (friction_ > 0 && anchors_.holds[std::size_t(touch.anchor)])
      sum += touch.area * touch.stiffness / 4 * anchors_.at[std::size_t(touch.anchor)].squaredNorm();
  });
  return sum;
}

}  // namespace lobe
