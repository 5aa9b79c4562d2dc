#include "lobe/contact/convex_gap.h"

#include <algorithm>

#include "lobe/cut/distance.h"

namespace lobe {
namespace {

// Between the segments from a to b and from c to d, from the first to the second.
Vec3d way_between(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d first = b - a, second = d - c, from = a - c;
  const double along = first.squaredNorm(), across = second.squaredNorm(), both = first.dot(second);
  const double determinant = along * across - both * both;
  const auto on_segment = [](double s) { return std::clamp(s, 0.0, 1.0); };
  double s =
      determinant > 0 ? on_segment((both * second.dot(from) - first.dot(from) * across) / determinant) : 0;
  const double t = across > 0 ? on_segment((both * s + second.dot(from)) / across) : 0;
  s = along > 0 ? on_segment((both * t - first.dot(from)) / along) : 0;
  return c + t * second - (a + s * first);
}

}  // namespace

Vec3d shortest_way(const Mat34<double>& tet, const Mat3<double>& triangle) {
  Vec3d best = triangle.col(0) - tet.col(0);
  const auto take = [&](const Vec3d& way) {
    if (way.squaredNorm() < best.squaredNorm()) best = way;
  };
  for (int c = 0; c < 4; ++c)
    take(nearest_on_triangle(tet.col(c), triangle.col(0), triangle.col(1), triangle.col(2)) - tet.col(c));
  for (int k = 0; k < 3; ++k) {
    const Vec3d x = triangle.col(k), y = triangle.col((k + 1) % 3);
    for (int c = 0; c < 4; ++c)  // the face opposite to it
      take(x - nearest_on_triangle(x, tet.col((c + 1) % 4), tet.col((c + 2) % 4), tet.col((c + 3) % 4)));
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) take(way_between(tet.col(a), tet.col(b), x, y));
  }
  return best;
}

}  // namespace lobe
