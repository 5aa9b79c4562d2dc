#include "lobe/diagnostics/overlap.h"

#include <algorithm>
#include <cmath>

namespace lobe {
namespace {

constexpr double touching = 1e-6;  // of an edge: how far rounding and single precision may move a point

double mean_edge(const TetMesh& mesh, Index tet) {
  const Mat34<double> X = tet_points(mesh, tet);
  double sum = 0;
  for (const auto& [a, b] : edge_corners) sum += (X.col(a) - X.col(b)).norm();
  return sum / 6;
}

}  // namespace

// The rule of degree two: weights V/4 at barycentric coordinates (5 + 3√5)/20 once and (5 − √5)/20 three
// times.
Coverage for_each_overlap(const Locator& a, const TetMesh& b,
                          const std::function<void(const OverlapPoint&)>& visit) {
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  Coverage coverage;
  double total = 0, outside = 0, far_outside = 0;
  OverlapPoint point;
  for (Index t = 0; t < b.tet_count(); ++t) {
    const Mat34<double> X = tet_points(b, t);
    point.tet_b = t;
    point.volume = signed_volume(X) / 4;
    total += 4 * point.volume;
    for (int corner = 0; corner < 4; ++corner) {
      point.at_b = Eigen::Vector4d::Constant(far);
      point.at_b[corner] = near;
      const Vec3d p = X * point.at_b;
      const Locator::Found found = a.nearest(p, point.tet_a);
      const double edge = found.distance > 0 ? mean_edge(a.mesh(), found.tet) : 0;
      point.tet_a = found.tet;
      point.at_a = barycentric(a.mesh(), found.tet, p);
      point.outside = found.distance > touching * edge ? found.distance : 0;
      if (point.outside > 0) outside += point.volume;
      if (point.outside > edge) far_outside += point.volume;
      coverage.largest_gap = std::max(coverage.largest_gap, point.outside);
      visit(point);
    }
  }
  coverage.outside_fraction = outside / total;
  coverage.far_fraction = far_outside / total;
  return coverage;
}

std::vector<VertexPlace> vertex_places(const Locator& a, const TetMesh& b) {
  std::vector<VertexPlace> places(std::size_t(b.vertex_count()));
  Index guess = -1;
  for (Index t = 0; t < b.tet_count(); ++t)
    for (int c = 0; c < 4; ++c) {
      VertexPlace& place = places[std::size_t(b.tets(c, t))];
      if (place.tet >= 0) continue;
      const Vec3d p = b.points.col(b.tets(c, t));
      guess = place.tet = a.nearest(p + touching * (barycentre(b, t) - p), guess).tet;
      place.at = barycentric(a.mesh(), place.tet, p);
    }
  return places;
}

Vec3d interpolate(const TetMesh& mesh, const Mat3X<double>& u, Index tet, const Eigen::Vector4d& at) {
  Vec3d sum = Vec3d::Zero();
  for (int c = 0; c < 4; ++c) sum += at[c] * u.col(mesh.tets(c, tet));
  return sum;
}

}  // namespace lobe
