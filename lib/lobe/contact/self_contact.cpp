#include "lobe/contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/cut/distance.h"

namespace lobe {

// ---- Where the two overlap

// The face of the boundary that is nearest at rest to a point of a tetrahedron; −1: the point is outside.
int SelfContact::face_at(const Layer& layer, const Vec3d& rest) const {
  int nearest = -1;
  if (layer.count > 0) {  // of planes around a convex cell the nearest is the highest
    double highest = -std::numeric_limits<double>::infinity();
    for (int f = layer.first; f < layer.first + layer.count; ++f) {
      const double g = planes_[std::size_t(f)].normal.dot(rest - planes_[std::size_t(f)].corner);
      if (g <= highest) continue;
      highest = g;
      nearest = f;
    }
    return highest < 0 ? nearest : -1;
  }
  double least = std::numeric_limits<double>::infinity();
  for (Index v : layer.corners)
    for (int i = first_of_vertex_[std::size_t(v)]; i < first_of_vertex_[std::size_t(v) + 1]; ++i) {
      const int f = of_vertex_[std::size_t(i)];
      const Mat3<double>& X = rest_[std::size_t(f)];
      const double square = (rest - nearest_on_triangle(rest, X.col(0), X.col(1), X.col(2))).squaredNorm();
      if (square >= least) continue;
      least = square;
      nearest = f;
    }
  return nearest;
}

void SelfContact::invert(const At& at) {
  for (std::size_t i = 0; i < unique_.size(); ++i) {
    const Eigen::Vector4i& v = unique_[i].corners;
    Inverse& own = inverses_[i];
    own.origin = at.of_mesh.col(v[0]);
    Mat3<double> edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = at.of_mesh.col(v[c + 1]) - own.origin;
    own.is_sound = edges.determinant() > 0;
    if (own.is_sound) own.to_weights = edges.inverse();
  }
}

bool SelfContact::find_touch(const At& at, const Candidate& own, const Vec3d& weights, Touch& touch) const {
  const Vec3d x = at.x(Eigen::all, own.points) * weights;
  for (int i = own.first; i < own.first + own.count; ++i) {
    const Inverse& inverse = inverses_[std::size_t(unique_of_[std::size_t(i)])];
    if (!inverse.is_sound) continue;
    const Vec3d b = inverse.to_weights * (x - inverse.origin);
    const double b0 = 1 - b.sum();
    if (b0 < 0 || b.minCoeff() < 0) continue;
    const Layer& layer = layers_[std::size_t(tets_[std::size_t(i)].layer)];
    const Vec3d rest = layer.rest * Eigen::Vector4d(b0, b[0], b[1], b[2]);
    const int face = face_at(layer, rest);
    if (face < 0) continue;
    const ContactSurface::Triangle& other = at.surface.triangles()[std::size_t(face)];
    Mat3<double> y;
    for (int c = 0; c < 3; ++c) {
      touch.face_points[c] = place_of_[std::size_t(other.points[c])];
      y.col(c) = at.x.col(touch.face_points[c]);
    }
    const Vec3d n = (y.col(1) - y.col(0)).cross(y.col(2) - y.col(0));
    const double square = n.squaredNorm();
    if (!(square > 0)) continue;
    touch.normal = n / std::sqrt(square);
    touch.depth = -touch.normal.dot(x - y.col(0));
    if (!(touch.depth > 0)) continue;
    const Vec3d foot = x + touch.depth * touch.normal;
    touch.face_weights[1] = (y.col(2) - y.col(0)).cross(foot - y.col(0)).dot(n) / -square;
    touch.face_weights[2] = (y.col(1) - y.col(0)).cross(foot - y.col(0)).dot(n) / square;
    touch.face_weights[0] = 1 - touch.face_weights[1] - touch.face_weights[2];
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(own.triangle)];
    const double a = triangle.stiffness, c = other.stiffness;
    touch.stiffness = a + c > 0 ? a * c / (a + c) / 2 : 0;
    touch.area = triangle.area / (divisions * divisions);
    touch.candidate = &own;
    touch.weights = weights;
    touch.face = face;
    return true;
  }
  return false;
}

// ---- Forces

// Per area, on the point [Pa]; `next_` takes ξ.
Vec3d SelfContact::friction_of(const At& at, const Touch& touch, double pressure) {
  const auto i = std::size_t(touch.anchor);
  Vec3d slip = Vec3d::Zero();
  if (anchors_.holds[i]) {
    const Vec3d speed = at.v(Eigen::all, touch.candidate->points) * touch.weights -
                        at.v(Eigen::all, touch.face_points) * touch.face_weights;
    slip = anchors_.at[i] + at.since * speed;
    slip -= touch.normal * touch.normal.dot(slip);
  }
  const double force = touch.stiffness / 2 * slip.norm(), most = friction_ * pressure;
  if (force > most) slip *= most / force;
  next_.holds[i] = 1;
  next_.at[i] = slip;
  return -touch.stiffness / 2 * slip;
}

void SelfContact::add_forces(const At& at, Mat3X<double>& f) {
  next_.let_go();
  visit_touches(at, [&](const Touch& touch) {
    double pressure = at.law.pressure(touch.depth, touch.stiffness);
    if (at.law.damping > 0) {
      const Vec3d speed = at.v(Eigen::all, touch.candidate->points) * touch.weights -
                          at.v(Eigen::all, touch.face_points) * touch.face_weights;
      pressure = std::max(0.0, pressure - at.law.damping * touch.stiffness * touch.normal.dot(speed));
    }
    Vec3d traction = pressure * touch.normal;
    if (friction_ > 0) traction += friction_of(at, touch, pressure);
    const Vec3d force = touch.area * traction;
    for (int c = 0; c < 3; ++c) {
      f.col(touch.candidate->points[c]) += touch.weights[c] * force;
      f.col(touch.face_points[c]) -= touch.face_weights[c] * force;
    }
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
