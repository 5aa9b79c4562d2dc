#include "lobe/contact/self_touch.h"

#include <Eigen/Geometry>
#include <cmath>

namespace lobe {

void SelfTouch::rebuild(const ContactSurface& surface) {
  scratch_.faces.assign(surface.triangles().size(), {});
  known_faces_.assign(surface.triangles().size() * most_self_points, {});
}

// ---- Where the two overlap

void SelfTouch::find_insides(const SelfAt& at, bool with_speeds) {
  const ClosePairs& close = watch_.close();
  const SelfPoints& points = watch_.points();
  if (scratch_.numbering != watch_.numbering())
    for (std::vector<double>* rows : {&scratch_.places, &scratch_.speeds, &scratch_.forces})
      rows->assign(points.x.size(), 0);
  scratch_.numbering = watch_.numbering();
  at.places.of_vertices(close.vertices, close.places, scratch_.places.data(),
                        with_speeds ? scratch_.speeds.data() : nullptr);
  for (int place : close.between) {
    const SelfPoints::Between& own = points.between[std::size_t(place) - points.vertices.size()];
    own.find(scratch_.places.data(), &scratch_.places[4 * std::size_t(place)]);
    if (with_speeds) own.find(scratch_.speeds.data(), &scratch_.speeds[4 * std::size_t(place)]);
  }
  constexpr double slack = 1e-9;
  scratch_.insides.resize(close.blocks.size());
  for (const ClosePairs::OfDivisions& kind : close.kinds) {
    const std::vector<Vec3d>& weights = self_point_weights(kind.divisions);
    kernels_.find_insides(scratch_.places.data(), weights.front().data(), static_cast<int>(weights.size()),
                          slack, &close.blocks[std::size_t(kind.first_block)],
                          &scratch_.insides[std::size_t(kind.first_block)], kind.blocks);
  }
}

Eigen::Vector4d SelfTouch::weights_in(int pair, const Vec3d& weights) const {
  const InsideBlock& block = scratch_.insides[std::size_t(pair) / PairBlock::width];
  const std::size_t lane = std::size_t(pair) % PairBlock::width;
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k)
      b[Eigen::Index(k) + 1] += weights[Eigen::Index(c)] * block.weights[c][k][lane];
  b[0] = 1 - (b[1] + b[2] + b[3]);
  return b;
}

// Rounding, or the slack of find_insides(), may put a point beyond a face of its tetrahedron that it lies on.
// It counts as on the face: beyond it the body has no place, and no face that the point could be behind.
Vec3d SelfTouch::place_at_rest(const BoundaryLayer::Tet& tet, const Eigen::Vector4d& weights) {
  if (!(weights.minCoeff() < 0)) return tet.rest * weights;
  const Eigen::Vector4d within = weights.cwiseMax(0);
  return tet.rest * (within / within.sum());
}

// The same face as the boundary layer finds, which is not asked for where it cannot have changed.
int SelfTouch::nearest_face(int point, int layer, const Vec3d& rest) {
  KnownFace& known = known_faces_[std::size_t(point)];
  const bool is_known = known.layer == layer &&
                        (rest - known.rest).squaredNorm() < known.nearest.room * known.nearest.room &&
                        rest_.boundary.is_behind(known.nearest.face, rest);
  if (!is_known) known = {layer, rest, rest_.boundary.nearest_face(rest_.layer(layer), rest)};
  return known.nearest.face;
}

auto SelfTouch::face_now(const SelfAt& at, int face, bool with_speeds) -> Face& {
  Face& now = scratch_.faces[std::size_t(face)];
  if (now.pass == pass_) return now;
  now.pass = pass_;
  const Eigen::Vector3i& points = at.surface.triangles()[std::size_t(face)].points;
  Mat3<double> y;
  for (int c = 0; c < 3; ++c) y.col(c) = at.places.of_point(points[c]);
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
bool SelfTouch::find_pair(const ClosePairs::OfCandidate& ones, Touch& touch) const {
  const auto take = [&](int pair) {
    touch.pair = pair;
    touch.layer = pair_of(pair).layer;
    touch.corner_weights = weights_in(pair, touch.weights);
  };
  const auto is_in = [&](int pair) {
    if (insides_of(pair) <= 0 || !(insides_of(pair) >> touch.number & 1)) return false;
    const BoundaryLayer::Tet& tet = rest_.layer(pair_of(pair).layer);
    return tet.lips == 0 ||
           rest_.boundary.is_filled(tet, place_at_rest(tet, weights_in(pair, touch.weights)));
  };
  const int end = ones.first + ones.count;
  if (touch.anchor)
    for (int i = ones.first; i < end; ++i) {
      if (pair_of(i).tet != touch.anchor->in) continue;
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
bool SelfTouch::find_kept_face(const SelfAt& at, const ClosePairs::OfCandidate& ones, Touch& touch) const {
  const auto& triangles = at.surface.triangles();
  for (int i = ones.first; i < ones.first + ones.count; ++i) {
    const PairSearch::Pair& pair = pair_of(i);
    if (pair.tet != touch.anchor->in) continue;
    if (insides_of(i) < 0) return false;
    for (int f : rest_.boundary.faces_of(rest_.layer(pair.layer))) {
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

bool SelfTouch::find_touch(const SelfAt& at, const HeldDepths& held, const ClosePairs::OfCandidate& ones,
                           const Vec3d& x, bool with_speeds, Touch& touch) {
  const int number = touch.candidate->triangle;
  const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(number)];
  touch.held = held.any() ? held.at(triangle.points, touch.weights) : 0;
  const bool is_in = find_pair(ones, touch);
  if (is_in) {
    const Vec3d rest = place_at_rest(rest_.layer(touch.layer), touch.corner_weights);
    touch.face = nearest_face(most_self_points * number + touch.number, touch.layer, rest);
    if (touch.face < 0) return false;
  } else if (!(touch.held > 0 && touch.anchor && find_kept_face(at, ones, touch))) {
    return false;
  }
  Face& now = face_now(at, touch.face, with_speeds);
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
  const int other = rest_.body_of[std::size_t(touch.layer)], divisions = touch.candidate->divisions;
  touch.law = at.law;
  touch.law.deepest *= rest_.edge_ratio(triangle.body, other);
  touch.stiffness = a + c > 0 ? a * c / (a + c) : 0;
  if (!rest_.is_one_sided(triangle.body, other)) touch.stiffness /= 2;
  touch.area = triangle.area / (divisions * divisions);
  return true;
}

// ---- Forces

// ξ, which has followed where the point slides past the tetrahedron at a speed [m].
Vec3d SelfTouch::slip_of(const SelfAt& at, const Touch& touch, const Vec3d& speed, double pressure) const {
  if (!touch.anchor) return Vec3d::Zero();
  Vec3d slip = touch.anchor->at + at.since * speed;
  slip -= touch.now->normal * touch.now->normal.dot(slip);
  const double k = ContactLaw::slip_share * touch.stiffness, square = slip.squaredNorm();
  return slip * at.law.held_share(pressure, k * k * square, k * std::sqrt(square));
}

template <int count>
void SelfTouch::add_at(int pair, int first, const Eigen::Matrix<double, 3, count>& forces) {
  for (int c = 0; c < count; ++c)
    Eigen::Map<Vec3d>(&scratch_.forces[4 * std::size_t(place_at(pair, std::size_t(first + c)))]) +=
        forces.col(c);
}

// Sums of forces on triangles, tetrahedra and faces, which go to vertices at the end.
void SelfTouch::add_forces(const SelfAt& at, ContactMemory& memory, ContactForces& f) {
  const bool has_friction = at.law.friction > 0, with_speeds = has_friction || at.law.damping > 0;
  scratch_.pressed.clear();
  int pair = -1;  // the last
  Mat3<double> speeds, on_triangle;
  Mat34<double> tet_speeds, on_tet;
  const auto end_pair = [&] {
    if (pair < 0) return;
    add_at<3>(pair, 0, on_triangle);
    if (has_friction) add_at<4>(pair, 3, on_tet);
  };
  const auto begin_pair = [&](int next) {
    if (next == pair) return;
    end_pair();
    pair = next;
    on_triangle.setZero();
    on_tet.setZero();
    if (with_speeds) speeds = rows_at<3>(scratch_.speeds, pair, 0);
    if (has_friction) tet_speeds = rows_at<4>(scratch_.speeds, pair, 3);
  };
  visit_touches(at, memory, with_speeds, [&](const Touch& touch) {
    const Face& now = *touch.now;
    begin_pair(touch.pair);
    Vec3d speed = Vec3d::Zero(), slip = Vec3d::Zero();
    double approach = 0;
    if (with_speeds) {
      speed = speeds * touch.weights;
      approach = -now.normal.dot(Vec3d(speed - now.speeds * touch.face_weights));
    }
    const double pressure = touch.law.pressure(touch.depth, touch.held, touch.stiffness, approach);
    const Vec3d pushed = touch.area * pressure * now.normal;
    Vec3d force = pushed;
    if (has_friction) {
      slip = slip_of(at, touch, speed - tet_speeds * touch.corner_weights, pressure);
      const Vec3d rubbed = -touch.area * touch.stiffness * ContactLaw::slip_share * slip;
      force += rubbed;
      on_tet -= rubbed * touch.corner_weights.transpose();
    }
    on_triangle += force * touch.weights.transpose();
    press(touch, pushed);
    remember(at, touch, slip, memory);
  });
  end_pair();
  memory.held().end(at.surface, at.law, at.since);
  give_forces(at, f);
}

// The face, by minus that force [N].
void SelfTouch::press(const Touch& touch, const Vec3d& force) {
  Face& now = *touch.now;
  if (now.pressed != pass_) {
    now.pressed = pass_;
    scratch_.pressed.push_back(touch.face);
    now.forces.setZero();
  }
  now.forces -= force * touch.face_weights.transpose();
}

void SelfTouch::remember(const SelfAt& at, const Touch& touch, const Vec3d& slip,
                         ContactMemory& memory) const {
  const auto& triangles = at.surface.triangles();
  const FaceOwner& face = triangles[std::size_t(touch.face)].owner;
  Anchor& anchor = memory.add();
  anchor.tet = touch.candidate->owner.tet;
  anchor.code = touch.candidate->owner.code;
  anchor.divisions = touch.candidate->divisions;
  anchor.number = touch.number;
  anchor.at = slip;
  anchor.face_tet = face.tet;
  anchor.face_code = face.code;
  anchor.in = rest_.layer(touch.layer).tet;
  if (at.law.hold > 0)
    memory.held().add(touch.candidate->triangle, triangles[std::size_t(touch.candidate->triangle)].points,
                      touch.weights, touch.area * touch.stiffness, touch.depth);
}

void SelfTouch::give_forces(const SelfAt& at, ContactForces& f) {
  if (scratch_.pressed.empty()) return;
  const ClosePairs& close = watch_.close();
  const SelfPoints& points = watch_.points();
  std::vector<double>& forces = scratch_.forces;
  for (int place : close.between) {
    const SelfPoints::Between& own = points.between[std::size_t(place) - points.vertices.size()];
    Eigen::Map<Vec3d> force(&forces[4 * std::size_t(place)]);
    for (int c = 0; c < 4; ++c)
      Eigen::Map<Vec3d>(&forces[4 * std::size_t(own.of[c])]) += own.weights[c] * force;
    force.setZero();
  }
  for (std::size_t i = 0; i < close.places.size(); ++i) {
    Eigen::Map<Vec3d> force(&forces[4 * std::size_t(close.places[i])]);
    f.add_to_vertex(close.vertices[i], force);
    force.setZero();
  }
  for (int face : scratch_.pressed) {
    const Eigen::Vector3i& points_of_face = at.surface.triangles()[std::size_t(face)].points;
    for (int c = 0; c < 3; ++c)
      f.add_to_point(points_of_face[c], scratch_.faces[std::size_t(face)].forces.col(c));
  }
}

double SelfTouch::energy(const SelfAt& at, ContactMemory& memory) {
  double sum = 0;
  visit_touches(at, memory, false, [&](const Touch& touch) {
    sum += touch.area * touch.law.energy(touch.depth, touch.held, touch.stiffness);
    if (touch.anchor) sum += touch.area * touch.stiffness / 4 * touch.anchor->at.squaredNorm();
  });
  return sum;
}

}  // namespace lobe
