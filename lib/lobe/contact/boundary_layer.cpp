#include "lobe/contact/boundary_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/contact/fill_lists.h"
#include "lobe/cut/distance.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// A point on a face is behind it, whatever rounding says: to take another face for it would be to take it for
// deep [m].
constexpr double just_behind = 1e-12;
// By how much rounding may change distances within a body, and more: lips of a closed cut are equally near
// but for that, and which is nearer says nothing about points beside [m].
constexpr double rounding_of_distances = 1e-13;

}  // namespace

void BoundaryLayer::rebuild(const ContactSurface& surface, const Elements& elements) {
  const auto vertices = std::size_t(elements.topology.vertex_count());
  const auto& triangles = surface.triangles();
  place_at_rest(surface, elements);
  fill_lists(surface.points().size(), first_around_, around_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int p : triangles[t].points) add(std::size_t(p), static_cast<int>(t));
  });
  fill_lists(vertices, first_of_vertex_, of_vertex_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int p : triangles[t].points) {
        const ContactSurface::Point& point = surface.points()[std::size_t(p)];
        for (int i = 0; i < point.count; ++i) add(std::size_t(point.corners[i]), static_cast<int>(t));
      }
  });
  std::vector<Index> tets;
  for (std::size_t v = 0; v < vertices; ++v)
    if (first_of_vertex_[v + 1] > first_of_vertex_[v])
      for (Index t : elements.topology.around(static_cast<Index>(v))) tets.push_back(t);
  sort_unique(tets);
  tets_.clear();
  faces_.clear();
  for (Index t : tets) {
    tets_.push_back({t, elements.topology.corners(t), elements.corner_points(t)});
    find_faces(tets_.back());
  }
  find_lips(surface, elements);
  stamp_of_vertex_.assign(vertices, -1);
  stamp_of_tet_.assign(tets_.size(), -1);
  list_own(surface);
}

int BoundaryLayer::number_of(Index tet) const {
  return static_cast<int>(std::lower_bound(tets_.begin(), tets_.end(), tet,
                                           [](const Tet& own, Index number) { return own.tet < number; }) -
                          tets_.begin());
}

void BoundaryLayer::place_at_rest(const ContactSurface& surface, const Elements& elements) {
  planes_.clear();
  rest_.clear();
  balls_.clear();
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    Mat3<double> X = Mat3<double>::Zero();
    for (int c = 0; c < 3; ++c) {
      const ContactSurface::Point& point = surface.points()[std::size_t(triangle.points[c])];
      for (int i = 0; i < point.count; ++i)
        X.col(c) += point.weights[i] * elements.points.col(point.corners[i]);
    }
    const Vec3d n = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0));
    planes_.push_back({n.norm() > 0 ? Vec3d(n.normalized()) : Vec3d::Zero(), X.col(0)});
    rest_.push_back(X);
    const Vec3d centre = X.rowwise().mean();
    balls_.push_back({centre, (X.colwise() - centre).colwise().norm().maxCoeff()});
  }
}

void BoundaryLayer::find_lips(const ContactSurface& surface, const Elements& elements) {
  const auto& triangles = surface.triangles();
  std::vector<int> first;
  fill_lists(tets_.size(), first, lips_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (const Index tet = triangles[t].owner.tet; triangles[t].is_cut && elements.share_of(tet) < 1)
        add(std::size_t(number_of(tet)), static_cast<int>(t));
  });
  for (std::size_t l = 0; l < tets_.size(); ++l) {
    tets_[l].first_lip = first[l];
    tets_[l].lips = first[l + 1] - first[l];
  }
}

// Of the triangles around its corners, but for those that it is in front of, and those that are farther from
// all of it than another is. The distance to a triangle is a convex function, and no larger in the
// tetrahedron than at one of its corners. The nearest come first.
void BoundaryLayer::find_faces(Tet& tet) {
  std::vector<int> around;
  for (Index v : tet.corners)
    around.insert(around.end(), of_vertex_.begin() + first_of_vertex_[std::size_t(v)],
                  of_vertex_.begin() + first_of_vertex_[std::size_t(v) + 1]);
  sort_unique(around);
  const auto distance = [&](const Vec3d& x, int f) { return std::sqrt(square_to(f, x)); };
  const Vec3d centre = tet.rest.rowwise().mean();
  const double radius = (tet.rest.colwise() - centre).colwise().norm().maxCoeff();
  const auto heights = [&](int f) -> Eigen::RowVector4d {  // over its plane
    const Plane& plane = planes_[std::size_t(f)];
    return plane.normal.transpose() * (tet.rest.colwise() - plane.corner);
  };
  double most = std::numeric_limits<double>::infinity();
  for (int f : around) {
    if (heights(f).maxCoeff() > 1e-9 * radius) continue;  // no face for all of its points
    double farthest = 0;
    for (int c = 0; c < 4; ++c) farthest = std::max(farthest, distance(tet.rest.col(c), f));
    most = std::min(most, farthest);
  }
  tet.first_face = static_cast<int>(faces_.size());
  std::vector<std::pair<double, int>> found;  // distance from the centre, face
  for (int f : around)
    if (heights(f).minCoeff() < -1e-9 * radius) {
      const double away = distance(centre, f);
      if (away - radius <= most * (1 + 1e-9)) found.emplace_back(away, f);
    }
  std::sort(found.begin(), found.end());
  for (const auto& [away, f] : found) faces_.push_back(f);
  tet.faces = static_cast<int>(faces_.size()) - tet.first_face;
}

// The vertices of a triangle and its neighbours.
std::vector<int> BoundaryLayer::vertices_around(const ContactSurface& surface, int triangle) {
  std::vector<int> found;
  for (int around : surface.triangles()[std::size_t(triangle)].points)
    for (int i = first_around_[std::size_t(around)]; i < first_around_[std::size_t(around) + 1]; ++i)
      for (int p : surface.triangles()[std::size_t(around_[std::size_t(i)])].points) {
        const ContactSurface::Point& point = surface.points()[std::size_t(p)];
        for (int c = 0; c < point.count; ++c)
          if (std::exchange(stamp_of_vertex_[std::size_t(point.corners[c])], triangle) != triangle)
            found.push_back(point.corners[c]);
      }
  return found;
}

// Of each triangle: the tetrahedra that have a vertex of those and are on its side of the surface.
void BoundaryLayer::list_own(const ContactSurface& surface) {
  std::vector<int> first_with, with;  // tetrahedra around each vertex
  fill_lists(stamp_of_vertex_.size(), first_with, with, [&](auto&& add) {
    for (std::size_t l = 0; l < tets_.size(); ++l)
      for (int v : tets_[l].corners) add(std::size_t(v), static_cast<int>(l));
  });
  own_.clear();
  first_own_.assign(1, 0);
  const auto count = static_cast<int>(surface.triangles().size());
  for (int t = 0; t < count; ++t) {
    for (int v : vertices_around(surface, t))
      for (int i = first_with[std::size_t(v)]; i < first_with[std::size_t(v) + 1]; ++i) {
        const auto l = std::size_t(with[std::size_t(i)]);
        if (std::exchange(stamp_of_tet_[l], t) != t && is_on_its_side(surface, t, tets_[l]))
          own_.push_back(with[std::size_t(i)]);
      }
    first_own_.push_back(static_cast<int>(own_.size()));
  }
}

// Nearly: of one that is filled in part, a place behind its cut faces.
Vec3d BoundaryLayer::middle_of_filled(const Tet& tet) const {
  if (tet.lips == 0) return tet.rest.rowwise().mean();
  const double behind = 0.2 * (tet.rest.col(1) - tet.rest.col(0)).norm();
  Vec3d sum = Vec3d::Zero();
  for (int f : lips_of(tet)) sum += balls_[std::size_t(f)].centre - behind * planes_[std::size_t(f)].normal;
  return sum / tet.lips;
}

bool BoundaryLayer::is_on_its_side(const ContactSurface& surface, int triangle, const Tet& tet) const {
  if (surface.triangles()[std::size_t(triangle)].owner.tet == tet.tet) return true;
  return planes_[std::size_t(triangle)].height(middle_of_filled(tet)) <
         0.05 * (tet.rest.col(1) - tet.rest.col(0)).norm();
}

double BoundaryLayer::square_to(int face, const Vec3d& rest) const {
  const Mat3<double>& X = rest_[std::size_t(face)];
  return (rest - nearest_on_triangle(rest, X.col(0), X.col(1), X.col(2))).squaredNorm();
}

bool BoundaryLayer::is_behind(int face, const Vec3d& rest) const {
  return planes_[std::size_t(face)].height(rest) <= just_behind;
}

auto BoundaryLayer::nearest_face(const Tet& tet, const Vec3d& rest) const -> Nearest {
  int nearest = -1;
  double square = std::numeric_limits<double>::infinity();
  for (int f : faces_of(tet)) {
    const double g = planes_[std::size_t(f)].height(rest);
    if (g > just_behind || g * g >= square) continue;  // it is no nearer than its plane
    const double own = square_to(f, rest);
    if (own >= square) continue;
    square = own;
    nearest = f;
  }
  return {nearest, nearest < 0 ? 0 : room_about(tet, rest, nearest, square)};
}

// Of cut faces that are equally near, as on a common edge, the one counts whose plane it is farthest from.
bool BoundaryLayer::is_filled(const Tet& tet, const Vec3d& rest) const {
  constexpr double equally = 1e-9;
  double least = std::numeric_limits<double>::infinity(), height = 0;  // square; over the plane
  for (int f : lips_of(tet)) {
    const double square = square_to(f, rest), own = planes_[std::size_t(f)].height(rest);
    if (square < (1 - equally) * least ||
        (square <= (1 + equally) * least && std::abs(own) > std::abs(height))) {
      least = square;
      height = own;
    }
  }
  return height <= just_behind;
}

// Within how far of there no other face is nearer. If a point moves by δ, so does no distance change by more
// than δ; a face that it is in front of by g is none for it until it has moved by g.
double BoundaryLayer::room_about(const Tet& tet, const Vec3d& rest, int nearest, double square) const {
  const double least = std::sqrt(square);
  double room = std::numeric_limits<double>::infinity();
  for (int f : faces_of(tet)) {
    if (f == nearest) continue;
    const Ball& ball = balls_[std::size_t(f)];
    const double g = planes_[std::size_t(f)].height(rest);
    const auto room_at = [&](double distance) { return std::max((distance - least) / 2, g - just_behind); };
    if (room_at(std::max(std::abs(g), (rest - ball.centre).norm() - ball.radius)) >= room) continue;
    room = std::min(room, room_at(std::sqrt(square_to(f, rest))));
  }
  return std::max(0.0, 0.999 * room - rounding_of_distances);
}

}  // namespace lobe
