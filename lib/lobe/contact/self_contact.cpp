#include "lobe/contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/cut/distance.h"

namespace lobe {

// ---- Where the two overlap

const std::array<Vec3d, SelfContact::points_per_triangle>& SelfContact::point_weights() {
  static const auto weights = [] {
    std::array<Vec3d, points_per_triangle> found;
    visit_centroids(divisions, [&](int number, const Vec3d& own) { found[std::size_t(number)] = own; });
    return found;
  }();
  return weights;
}

// Rounding, or the slack of find_insides(), may put a point beyond a face of its tetrahedron that it lies on.
// It counts as on that face. In front of it, the point would be behind other faces only, however far they are.
Vec3d SelfContact::place_at_rest(const BoundaryLayer::Tet& tet, const Eigen::Vector4d& weights) {
  if (!(weights.minCoeff() < 0)) return tet.rest * weights;
  const Eigen::Vector4d within = weights.cwiseMax(0);
  return tet.rest * (within / within.sum());
}

// The same face as the boundary layer finds, which is not asked for where it cannot have changed.
int SelfContact::nearest_face(int point, int layer, const Vec3d& rest) {
  KnownFace& known = known_faces_[std::size_t(point)];
  const bool is_known = known.layer == layer &&
                        (rest - known.rest).squaredNorm() < known.nearest.room * known.nearest.room &&
                        boundary_.is_behind(known.nearest.face, rest);
  if (!is_known) known = {layer, rest, boundary_.nearest_face(layer_at(layer), rest)};
  return known.nearest.face;
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
  const Eigen::Vector4i& v = layer_at(layer).corners;
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
  for (int c = 0; c < 4; ++c) x.col(c) = now.of_vertex(layer_at(layer).corners[c]);
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
    for (int c = 0; c < 4; ++c) x.col(c) = at.places.of_vertex(layer_at(pair.layer).corners[c]);
    bool is_parted = gap_beyond(x, pair.face, points) > near_;
    for (int face = 0; face < 4 && !is_parted; ++face) {
      is_parted = gap_beyond(x, face, points) > near_;
      if (is_parted) pair.face = static_cast<std::uint8_t>(face);
    }
    if (!is_parted) near_pairs_.push_back(i);
  }
}

void SelfContact::find_insides(const At& at, bool with_speeds) {
  at.places.of_vertices(close_vertices_, close_places_, now_.data(), with_speeds ? speeds_.data() : nullptr);
  for (int place : close_between_) {
    const Placed::Between& own =
        watched_placed_.between[std::size_t(place) - watched_placed_.vertices.size()];
    own.find(now_.data(), &now_[4 * std::size_t(place)]);
    if (with_speeds) own.find(speeds_.data(), &speeds_[4 * std::size_t(place)]);
  }
  constexpr double slack = 1e-9;
  kernels_.find_insides(now_.data(), point_weights().front().data(), points_per_triangle, slack,
                        close_blocks_.data(), insides_.data(), static_cast<int>(close_blocks_.size()));
}

Eigen::Vector4d SelfContact::weights_in(int pair, const Vec3d& weights) const {
  const InsideBlock& block = insides_[std::size_t(pair) / PairBlock::width];
  const std::size_t lane = std::size_t(pair) % PairBlock::width;
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k)
      b[Eigen::Index(k) + 1] += weights[Eigen::Index(c)] * block.weights[c][k][lane];
  b[0] = 1 - (b[1] + b[2] + b[3]);
  return b;
}

auto SelfContact::face_now(const At& at, int face, bool with_speeds) -> FaceNow& {
  FaceNow& now = faces_now_[std::size_t(face)];
  if (now.pass == pass_) return now;
  now.pass = pass_;
  const Eigen::Vector3i& points = at.surface.triangles()[std::size_t(face)].points;
  const Mat3<double> y = corners_of(at, face);
  now.corner = y.col(0);
  const Vec3d e = y.col(1) - y.col(0), g = y.col(2) - y.col(0), n = e.cross(g);
  const double square = n.squaredNorm();
  now.is_sound = square > 0;
  if (!now.is_sound) return now;
  now.normal = n / std::sqrt(square);
  now.to_weights[0] = g.cross(n) / square;
  now.to_weights[1] = n.cross(e) / square;
  if (with_speeds)
    for (int c = 0; c < 3; ++c) now.speeds.col(c) = at.places.velocity_of_point(points[c]);
  return now;
}

// The first of the candidate's tetrahedra that a point is in, and its barycentric coordinates there. The one
// that it was in last is tried before, and is the only one but where the point is on a face.
bool SelfContact::find_pair(const CloseOnes& ones, Touch& touch) const {
  const auto take = [&](int pair) {
    touch.pair = pair;
    touch.layer = pairs_[std::size_t(close_[std::size_t(pair)])].layer;
    touch.corner_weights = weights_in(pair, touch.weights);
  };
  const auto is_in = [&](int pair) {
    if (insides_of(pair) <= 0 || !(insides_of(pair) >> touch.number & 1)) return false;
    const BoundaryLayer::Tet& layer = layer_at(pairs_[std::size_t(close_[std::size_t(pair)])].layer);
    return layer.lips == 0 ||
           boundary_.is_filled(layer, place_at_rest(layer, weights_in(pair, touch.weights)));
  };
  const int end = ones.first + ones.count;
  if (touch.anchor)
    for (int i = ones.first; i < end; ++i) {
      if (pairs_[std::size_t(close_[std::size_t(i)])].tet != touch.anchor->in) continue;
      if (!is_in(i)) break;
      take(i);
      return true;
    }
  for (int i = ones.first; i < end; ++i) {
    if (!is_in(i)) continue;
    take(i);
    if (!(touch.corner_weights.minCoeff() < 0)) return true;
  }
  return false;
}

// A point that is held and has come out still has the face that it has come through.
bool SelfContact::find_kept_face(const At& at, const CloseOnes& ones, Touch& touch) const {
  const auto& triangles = at.surface.triangles();
  for (int i = ones.first; i < ones.first + ones.count; ++i) {
    const Pair& pair = pairs_[std::size_t(close_[std::size_t(i)])];
    if (pair.tet != touch.anchor->in) continue;
    const BoundaryLayer::Tet& layer = layer_at(pair.layer);
    if (insides_of(i) < 0) return false;
    for (int f : boundary_.faces_of(layer)) {
      const FaceOwner& owner = triangles[std::size_t(f)].owner;
      if (owner.tet != touch.anchor->face_tet || owner.code != touch.anchor->face_code) continue;
      touch.face = f;
      touch.pair = i;
      touch.layer = pair.layer;
      touch.corner_weights = weights_in(i, touch.weights);
      return true;
    }
  }
  return false;
}

bool SelfContact::find_touch(const At& at, const CloseOnes& ones, const Vec3d& x, bool with_speeds,
                             Touch& touch) {
  const int number = touch.candidate->triangle;
  const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(number)];
  touch.held = memory_.held().any() ? memory_.held().at(triangle.points, touch.weights) : 0;
  const bool is_in = find_pair(ones, touch);
  if (is_in) {
    const Vec3d rest = place_at_rest(layer_at(touch.layer), touch.corner_weights);
    touch.face = nearest_face(points_per_triangle * number + touch.number, touch.layer, rest);
    if (touch.face < 0) return false;
  } else if (!(touch.held > 0 && touch.anchor && find_kept_face(at, ones, touch))) {
    return false;
  }
  FaceNow& now = face_now(at, touch.face, with_speeds);
  if (!now.is_sound) return false;
  touch.now = &now;
  const Vec3d way = x - now.corner;
  touch.depth = -now.normal.dot(way);
  if (!(touch.depth + touch.held > 0)) return false;
  touch.face_weights[1] = now.to_weights[0].dot(way);
  touch.face_weights[2] = now.to_weights[1].dot(way);
  touch.face_weights[0] = 1 - touch.face_weights[1] - touch.face_weights[2];
  constexpr double farthest_beside = -0.5;  // it has slid off
  if (!is_in && touch.face_weights.minCoeff() < farthest_beside) return false;
  const double a = at.surface.self_stiffness(number), c = at.surface.self_stiffness(touch.face);
  touch.stiffness = a + c > 0 ? a * c / (a + c) / 2 : 0;
  touch.area = triangle.area / points_per_triangle;
  return true;
}

// ---- Forces

// ξ, which has followed where the point slides past the tetrahedron at a speed [m].
Vec3d SelfContact::slip_of(const At& at, const Touch& touch, const Vec3d& speed, double pressure) const {
  if (!touch.anchor) return Vec3d::Zero();
  Vec3d slip = touch.anchor->at + at.since * speed;
  slip -= touch.now->normal * touch.now->normal.dot(slip);
  const double k = touch.stiffness / 2, most = friction_ * pressure, square = slip.squaredNorm();
  return k * k * square > most * most ? Vec3d(slip * (most / (k * std::sqrt(square)))) : slip;
}

// Of the corners of a pair, from those of places.
template <int count>
Eigen::Matrix<double, 3, count> SelfContact::rows_at(const std::vector<double>& rows, int pair,
                                                     int first) const {
  Eigen::Matrix<double, 3, count> found;
  for (int c = 0; c < count; ++c)
    found.col(c) = Eigen::Map<const Vec3d>(&rows[4 * std::size_t(place_at(pair, std::size_t(first + c)))]);
  return found;
}

template <int count>
void SelfContact::add_at(int pair, int first, const Eigen::Matrix<double, 3, count>& forces) {
  for (int c = 0; c < count; ++c)
    Eigen::Map<Vec3d>(&forces_[4 * std::size_t(place_at(pair, std::size_t(first + c)))]) += forces.col(c);
}

void SelfContact::remember(const At& at, const Touch& touch, const Vec3d& slip) {
  const auto& triangles = at.surface.triangles();
  const ContactSurface::Triangle& triangle = triangles[std::size_t(touch.candidate->triangle)];
  const FaceOwner& face = triangles[std::size_t(touch.face)].owner;
  Anchor& anchor = memory_.add();
  anchor.tet = triangle.owner.tet;
  anchor.code = triangle.owner.code;
  anchor.divisions = divisions;
  anchor.number = touch.number;
  anchor.at = slip;
  anchor.face_tet = face.tet;
  anchor.face_code = face.code;
  anchor.in = layer_at(touch.layer).tet;
  if (at.law.hold > 0)
    memory_.held().add(touch.candidate->triangle, triangle.points, touch.weights,
                       touch.area * touch.stiffness, touch.depth);
}

// Sums of forces on triangles, tetrahedra and faces, which go to vertices at the end.
void SelfContact::add_forces(const At& at, ContactForces& f) {
  const bool with_speeds = friction_ > 0 || at.law.damping > 0;
  pressed_faces_.clear();
  int pair = -1;  // the last
  Mat3<double> speeds, on_triangle;
  Mat34<double> tet_speeds, on_tet;
  const auto end_pair = [&] {
    if (pair < 0) return;
    add_at<3>(pair, 0, on_triangle);
    if (friction_ > 0) add_at<4>(pair, 3, on_tet);
  };
  const auto begin_pair = [&](int next) {
    if (next == pair) return;
    end_pair();
    pair = next;
    on_triangle.setZero();
    on_tet.setZero();
    if (with_speeds) speeds = rows_at<3>(speeds_, pair, 0);
    if (friction_ > 0) tet_speeds = rows_at<4>(speeds_, pair, 3);
  };
  visit_touches(at, with_speeds, [&](const Touch& touch) {
    FaceNow& now = *touch.now;
    begin_pair(touch.pair);
    double pressure = at.law.pressure(touch.depth, touch.held, touch.stiffness);
    Vec3d speed = Vec3d::Zero(), slip = Vec3d::Zero();
    if (with_speeds) speed = speeds * touch.weights;
    if (at.law.damping > 0) {
      const Vec3d approach = speed - now.speeds * touch.face_weights;
      pressure = std::max(0.0, pressure - at.law.damping * touch.stiffness * now.normal.dot(approach));
    }
    const Vec3d pushed = touch.area * pressure * now.normal;
    Vec3d force = pushed;
    if (friction_ > 0) {
      slip = slip_of(at, touch, speed - tet_speeds * touch.corner_weights, pressure);
      const Vec3d rubbed = -touch.area * touch.stiffness / 2 * slip;
      force += rubbed;
      on_tet -= rubbed * touch.corner_weights.transpose();
    }
    on_triangle += force * touch.weights.transpose();
    if (now.pressed != pass_) {
      now.pressed = pass_;
      pressed_faces_.push_back(touch.face);
      now.forces.setZero();
    }
    now.forces -= pushed * touch.face_weights.transpose();
    remember(at, touch, slip);
  });
  end_pair();
  memory_.held().end(at.surface, at.law, at.since);
  give_forces(at, f);
}

void SelfContact::give_forces(const At& at, ContactForces& f) {
  if (pressed_faces_.empty()) return;
  for (int place : close_between_) {
    const Placed::Between& own =
        watched_placed_.between[std::size_t(place) - watched_placed_.vertices.size()];
    Eigen::Map<Vec3d> force(&forces_[4 * std::size_t(place)]);
    for (int c = 0; c < 4; ++c)
      Eigen::Map<Vec3d>(&forces_[4 * std::size_t(own.of[c])]) += own.weights[c] * force;
    force.setZero();
  }
  for (std::size_t i = 0; i < close_places_.size(); ++i) {
    Eigen::Map<Vec3d> force(&forces_[4 * std::size_t(close_places_[i])]);
    f.add_to_vertex(close_vertices_[i], force);
    force.setZero();
  }
  for (int face : pressed_faces_) {
    const Eigen::Vector3i& points = at.surface.triangles()[std::size_t(face)].points;
    for (int c = 0; c < 3; ++c) f.add_to_point(points[c], faces_now_[std::size_t(face)].forces.col(c));
  }
}

double SelfContact::energy(const At& at) {
  double sum = 0;
  visit_touches(at, false, [&](const Touch& touch) {
    sum += touch.area * at.law.energy(touch.depth, touch.held, touch.stiffness);
    if (touch.anchor) sum += touch.area * touch.stiffness / 4 * touch.anchor->at.squaredNorm();
  });
  return sum;
}

}  // namespace lobe
