#include "lobe/forces/embedded.h"

#include <algorithm>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/scalpel/grains.h"

namespace lobe {

FoundPoint embed(const Locator& locator, const Vec3d& X) {
  const Locator::Found found = locator.nearest(X);
  Eigen::Vector4d weights = barycentric(locator.mesh(), found.tet, X);
  if (found.distance > 0) {
    weights = weights.cwiseMax(0);
    weights /= weights.sum();
  }
  return {{found.tet, weights}, found.distance};
}

Vec3d rest_position(const EmbeddedPoint& point, const Elements& elements) {
  return elements.corner_points(point.tet) * point.weights;
}

double distance_to_material(const Vec3d& X, Index tet, const Elements& elements, const Grains* grains) {
  if (!grains || elements.share_of(tet) == 1) return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Index grain : grains->of(tet)) {
    Mat34<double> corners;
    for (int k = 0; k < 4; ++k) corners.col(k) = grains->point((*grains)[grain].points[k]);
    nearest = std::min(nearest, distance_to_tet(X, corners));
  }
  return nearest;
}

void follow_division(EmbeddedPoint& point, const Elements& elements, const Grains& grains,
                     const MeshEdit& edit) {
  const auto is_of_point = [tet = point.tet](const TetCopy& made) { return made.tet == tet; };
  if (std::none_of(edit.copies.begin(), edit.copies.end(), is_of_point)) return;
  const Vec3d X = rest_position(point, elements);
  Index found = point.tet;
  double nearest = distance_to_material(X, point.tet, elements, &grains);
  for (const TetCopy& made : edit.copies) {
    if (!is_of_point(made)) continue;
    const double distance = distance_to_material(X, made.copy, elements, &grains);
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = made.copy;
  }
  point.tet = found;
}

namespace {

// The tetrahedron across a face whose material is nearest to X; −1: none, the face is on the surface.
Index across(Index tet, int face, const Vec3d& X, const Elements& elements, const Grains* grains) {
  Index found = -1;
  double nearest = std::numeric_limits<double>::infinity();
  elements.topology.for_neighbours(tet, [&](int at, Index other) {
    if (at != face) return;
    const double distance = distance_to_material(X, other, elements, grains);
    if (!(distance < nearest)) return;
    nearest = distance;
    found = other;
  });
  return found;
}

}  // namespace

template <class Real>
EmbeddedPoint moved_through(const EmbeddedPoint& point, const Vec3d& x, const Elements& elements,
                            const Grains* grains, const Mat3X<Real>& u) {
  constexpr int most_tets = 16;  // crossed in one step
  const auto corners_now = [&](Index tet) -> Mat34<double> {
    return elements.corner_points(tet) +
           u(Eigen::all, elements.topology.corners(tet)).template cast<double>();
  };
  EmbeddedPoint moved{point.tet, barycentric(corners_now(point.tet), x)};
  for (int crossed = 0; crossed < most_tets; ++crossed) {
    int face = 0;
    if (moved.weights.minCoeff(&face) >= 0) break;
    const Index next = across(moved.tet, face, rest_position(moved, elements), elements, grains);
    if (next < 0) return {};
    moved = {next, barycentric(corners_now(next), x)};
  }
  if (!moved.is_valid()) return point;  // in a flat tetrahedron: it stays where it is
  if (!grains) return moved;
  const double rounding = 1e-6 * grains->mean_edge();
  const Vec3d X = rest_position(moved, elements);
  return distance_to_material(X, moved.tet, elements, grains) > rounding ? EmbeddedPoint{} : moved;
}

template <class Real>
FoundPoint embed_now(const Vec3d& x, const Elements& elements, const Grains* grains, const Mat3X<Real>& u) {
  FoundPoint found{{}, std::numeric_limits<double>::infinity()};
  for (Index tet = 0; tet < elements.topology.tet_count(); ++tet) {
    if (!elements.topology.alive(tet)) continue;
    const Mat34<double> corners =
        elements.corner_points(tet) + u(Eigen::all, elements.topology.corners(tet)).template cast<double>();
    double distance = distance_to_tet(x, corners);
    if (!(distance < found.distance)) continue;
    Eigen::Vector4d weights = barycentric(corners, x);
    if (distance > 0) {
      weights = weights.cwiseMax(0);
      weights /= weights.sum();
    }
    distance += distance_to_material(elements.corner_points(tet) * weights, tet, elements, grains);
    if (distance < found.distance) found = {{tet, weights}, distance};
  }
  return found;
}

template FoundPoint embed_now(const Vec3d&, const Elements&, const Grains*, const Mat3X<float>&);
template FoundPoint embed_now(const Vec3d&, const Elements&, const Grains*, const Mat3X<double>&);
template EmbeddedPoint moved_through(const EmbeddedPoint&, const Vec3d&, const Elements&, const Grains*,
                                     const Mat3X<float>&);
template EmbeddedPoint moved_through(const EmbeddedPoint&, const Vec3d&, const Elements&, const Grains*,
                                     const Mat3X<double>&);

}  // namespace lobe
