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

Mat3<double> SelfContact::corners_of(const At& at, int triangle) const {
  Mat3<double> x;
  for (int c = 0; c < 3; ++c)
    x.col(c) = at.places.of_point(at.surface.triangles()[std::size_t(triangle)].points[c]);
  return x;
}

auto SelfContact::inverse(const Places& now, int layer) -> const Inverse& {
  Inverse& inverse_of = inverses_[std::size_t(layer)];
  if (inverse_of.pass == pass_) return inverse_of;
  inverse_of.pass = pass_;
  const Eigen::Vector4i& v = layers_[std::size_t(layer)].corners;
  inverse_of.origin = now.of_vertex(v[0]);
  Mat3<double> edges;
  for (int c = 0; c < 3; ++c) edges.col(c) = now.of_vertex(v[c + 1]) - inverse_of.origin;
  inverse_of.is_sound = edges.determinant() > 0;
  if (!inverse_of.is_sound) return inverse_of;
  inverse_of.to_weights = edges.inverse();
  inverse_of.heights << 1 / inverse_of.to_weights.colwise().sum().norm(),
      inverse_of.to_weights.rowwise().norm().cwiseInverse();
  return inverse_of;
}

Eigen::Vector4d SelfContact::Inverse::weights(const Vec3d& x) const {
  Eigen::Vector4d b;
  b.tail<3>() = to_weights * (x - origin);
  b[0] = 1 - b.tail<3>().sum();
  return b;
}

// Whether a point of a triangle is in a tetrahedron, or nearly so.
bool SelfContact::is_close(const Places& now, const Mat3<double>& corners, int layer) {
  const Inverse& tet = inverse(now, layer);
  Mat34<double> x;
  for (int c = 0; c < 4; ++c) x.col(c) = now.of_vertex(layers_[std::size_t(layer)].corners[c]);
  bool is_any = false;
  visit_centroids(divisions, [&](int, const Vec3d& weights) {
    const Vec3d point = corners * weights;
    if (is_any || (tet.is_sound && tet.gap(tet.weights(point)) > near_)) return;
    is_any = distance_to_tet(point, x) <= near_;
  });
  return is_any;
}

// By how much the outermost points of a triangle are beyond the plane of a face; NaN if that is flat [m].
double SelfContact::gap_beyond(const Mat34<double>& tet, int face, const Mat3<double>& outermost) {
  const Vec3d from = tet.col((face + 1) % 4);
  const Vec3d n = (tet.col((face + 2) % 4) - from).cross(tet.col((face + 3) % 4) - from);
  const double length = n.dot(tet.col(face) - from) < 0 ? n.norm() : -n.norm();
  return (n.transpose() * (outermost.colwise() - from) / length).minCoeff();
}

// The plane that parted a pair last parts most of them still.
void SelfContact::find_near_pairs(const At& at, const CloseOnes& ones, const Mat3<double>& corners) {
  near_pairs_.clear();
  const Mat3<double> points = outermost(corners);
  for (int i : close_of(ones)) {
    Pair& pair = pairs_[std::size_t(i)];
    Mat34<double> x;
    for (int c = 0; c < 4; ++c) x.col(c) = at.places.of_vertex(layers_[std::size_t(pair.layer)].corners[c]);
    bool is_parted = gap_beyond(x, pair.face, points) > near_;
    for (int face = 0; face < 4 && !is_parted; ++face) {
      is_parted = gap_beyond(x, face, points) > near_;
      if (is_parted) pair.face = static_cast<std::uint8_t>(face);
    }
    if (!is_parted) near_pairs_.push_back(i);
  }
}

// The first of the candidate's tetrahedra that a point is in, and its barycentric coordinates there; −1:
// none. The one that it was in last is tried before, and is the only one but where the point is on a face.
int SelfContact::find_tet(const At& at, const Candidate& candidate, const Vec3d& x, const Anchor* anchor,
                          Eigen::Vector4d& b) {
  const int end = candidate.first + candidate.count;
  if (anchor)
    for (int i = candidate.first; i < end; ++i) {
      const int layer = pairs_[std::size_t(i)].layer;
      if (layers_[std::size_t(layer)].tet != anchor->in) continue;
      const Inverse& tet = inverse(at.places, layer);
      if (!tet.is_sound) break;
      b = tet.weights(x);
      if (b.minCoeff() < -1e-9) break;
      return layer;
    }
  for (int i : near_pairs_) {
    const Pair& pair = pairs_[std::size_t(i)];
    const Inverse& tet = inverse(at.places, pair.layer);
    if (!tet.is_sound) continue;
    b = tet.weights(x);
    if (!(b.minCoeff() < 0)) return pair.layer;
  }
  return -1;
}

// A point that is held and has come out still has the face that it has come through.
bool SelfContact::find_kept_face(const At& at, const Candidate& candidate, const Vec3d& x, Touch& touch) {
  const auto& triangles = at.surface.triangles();
  for (int i = candidate.first; i < candidate.first + candidate.count; ++i) {
    const int number = pairs_[std::size_t(i)].layer;
    const Layer& layer = layers_[std::size_t(number)];
    if (layer.tet != touch.anchor->in) continue;
    const Inverse& tet = inverse(at.places, number);
    if (!tet.is_sound) return false;
    for (int f = layer.first; f < layer.first + layer.count; ++f) {
      const FaceOwner& owner = triangles[std::size_t(faces_[std::size_t(f)])].owner;
      if (owner.tet != touch.anchor->face_tet || owner.code != touch.anchor->face_code) continue;
      touch.face = faces_[std::size_t(f)];
      touch.layer = number;
      touch.corner_weights = tet.weights(x);
      return true;
    }
  }
  return false;
}

bool SelfContact::find_touch(const At& at, const Candidate& candidate, const Vec3d& x, Touch& touch) {
  const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(candidate.triangle)];
  touch.held = memory_.held().any() ? memory_.held().at(triangle.points, touch.weights) : 0;
  touch.layer = find_tet(at, candidate, x, touch.anchor, touch.corner_weights);
  const bool is_in = touch.layer >= 0;
  if (is_in) {
    const Layer& layer = layers_[std::size_t(touch.layer)];
    touch.face = face_at(layer, layer.rest * touch.corner_weights);
    if (touch.face < 0) return false;
  } else if (!(touch.held > 0 && touch.anchor && find_kept_face(at, candidate, x, touch))) {
    return false;
  }
  const Mat3<double> y = corners_of(at, touch.face);
  const Vec3d n = (y.col(1) - y.col(0)).cross(y.col(2) - y.col(0));
  const double square = n.squaredNorm();
  if (!(square > 0)) return false;
  touch.normal = n / std::sqrt(square);
  touch.depth = -touch.normal.dot(x - y.col(0));
  if (!(touch.depth + touch.held > 0)) return false;
  const Vec3d foot = x + touch.depth * touch.normal;
  touch.face_weights[1] = (y.col(2) - y.col(0)).cross(foot - y.col(0)).dot(n) / -square;
  touch.face_weights[2] = (y.col(1) - y.col(0)).cross(foot - y.col(0)).dot(n) / square;
  touch.face_weights[0] = 1 - touch.face_weights[1] - touch.face_weights[2];
  constexpr double farthest_beside = -0.5;  // it has slid off
  if (!is_in && touch.face_weights.minCoeff() < farthest_beside) return false;
  const double a = at.surface.self_stiffness(candidate.triangle), c = at.surface.self_stiffness(touch.face);
  touch.stiffness = a + c > 0 ? a * c / (a + c) / 2 : 0;
  touch.area = triangle.area / points_per_triangle;
  return true;
}

// ---- Forces

Vec3d SelfContact::speed_of(const At& at, const Touch& touch) const {
  const auto& points = at.surface.triangles()[std::size_t(touch.candidate->triangle)].points;
  Vec3d speed = Vec3d::Zero();
  for (int c = 0; c < 3; ++c) speed += touch.weights[c] * at.places.velocity_of_point(points[c]);
  return speed;
}

// ξ, which has followed where the point slides [m].
Vec3d SelfContact::slip_of(const At& at, const Touch& touch, double pressure) const {
  if (!touch.anchor) return Vec3d::Zero();
  Vec3d speed = speed_of(at, touch);
  const Eigen::Vector4i& corners = layers_[std::size_t(touch.layer)].corners;
  for (int c = 0; c < 4; ++c) speed -= touch.corner_weights[c] * at.places.velocity_of_vertex(corners[c]);
  Vec3d slip = touch.anchor->at + at.since * speed;
  slip -= touch.normal * touch.normal.dot(slip);
  const double force = touch.stiffness / 2 * slip.norm(), most = friction_ * pressure;
  return force > most ? Vec3d(slip * most / force) : slip;
}

void SelfContact::add_forces(const At& at, ContactForces& f) {
  const auto& triangles = at.surface.triangles();
  visit_touches(at, [&](const Touch& touch) {
    const ContactSurface::Triangle& triangle = triangles[std::size_t(touch.candidate->triangle)];
    const ContactSurface::Triangle& face = triangles[std::size_t(touch.face)];
    const Layer& layer = layers_[std::size_t(touch.layer)];
    double pressure = at.law.pressure(touch.depth, touch.held, touch.stiffness);
    if (at.law.damping > 0) {
      Vec3d speed = speed_of(at, touch);
      for (int c = 0; c < 3; ++c)
        speed -= touch.face_weights[c] * at.places.velocity_of_point(face.points[c]);
      pressure = std::max(0.0, pressure - at.law.damping * touch.stiffness * touch.normal.dot(speed));
    }
    const Vec3d slip = friction_ > 0 ? slip_of(at, touch, pressure) : Vec3d::Zero();
    const Vec3d pushed = touch.area * pressure * touch.normal;
    const Vec3d rubbed = -touch.area * touch.stiffness / 2 * slip;
    for (int c = 0; c < 3; ++c) {
      f.add_to_point(triangle.points[c], touch.weights[c] * (pushed + rubbed));
      f.add_to_point(face.points[c], -touch.face_weights[c] * pushed);
    }
    if (friction_ > 0)
      for (int c = 0; c < 4; ++c) f.add_to_vertex(layer.corners[c], -touch.corner_weights[c] * rubbed);
    memory_.add({.tet = triangle.owner.tet,
                 .code = triangle.owner.code,
                 .divisions = divisions,
                 .number = touch.number,
                 .at = slip,
                 .face_tet = face.owner.tet,
                 .face_code = face.owner.code,
                 .in = layer.tet});
    if (at.law.hold > 0)
      memory_.held().add(touch.candidate->triangle, triangle.points, touch.weights,
                         touch.area * touch.stiffness, touch.depth);
  });
  memory_.held().end(at.surface, at.law, at.since);
}

double SelfContact::energy(const At& at) {
  double sum = 0;
  visit_touches(at, [&](const Touch& touch) {
    sum += touch.area * at.law.energy(touch.depth, touch.held, touch.stiffness);
    if (touch.anchor) sum += touch.area * touch.stiffness / 4 * touch.anchor->at.squaredNorm();
  });
  return sum;
}

}  // namespace lobe
