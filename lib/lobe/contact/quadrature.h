// The points of a triangle at which contact is evaluated.
#pragma once

#include "lobe/types.h"

namespace lobe {

// The centroids of the n² triangles into which parallels to its edges divide one: barycentric coordinates.
template <class Visit>
void visit_centroids(int n, Visit&& visit) {
  const double third = 1.0 / (3 * n);
  int number = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n - j; ++i) {
      const double a = (3 * i + 1) * third, b = (3 * j + 1) * third;
      visit(number++, Vec3d(1 - a - b, a, b));
      if (i + j < n - 1) visit(number++, Vec3d(1 - a - b - 2 * third, a + third, b + third));
    }
}

inline constexpr int few_divisions = 4;

// Where these are in a triangle with the corners x: visit(number, place, weights()). They are found by strips
// along the first edge. A strip is left out if skip(middle, radius) says so of a ball that it lies in. Where
// there are few points that is not asked: it would take as long as they do.
template <class Skip, class Visit>
void visit_places(const Mat3<double>& x, int n, Skip&& skip, Visit&& visit) {
  const Vec3d along = (x.col(1) - x.col(0)) / n, up = (x.col(2) - x.col(0)) / n, turned = (along + up) / 3;
  const double third = 1.0 / (3 * n);
  const bool asks = n > few_divisions;
  const double length = asks ? along.norm() : 0, height = asks ? turned.norm() : 0;
  int number = 0;
  for (int j = 0; j < n; ++j) {
    const int last = n - j - 1;  // upright triangles before the last, and as many that are turned
    Vec3d place = x.col(0) + turned + j * up;
    if (asks && skip(place + 0.5 * last * along, 0.5 * last * length + height)) {
      number += 2 * last + 1;
      continue;
    }
    const double b = (3 * j + 1) * third;
    for (int i = 0; i <= last; ++i, place += along) {
      const double a = (3 * i + 1) * third;
      visit(number++, place, [&] { return Vec3d(1 - a - b, a, b); });
      if (i < last)
        visit(number++, place + turned, [&] { return Vec3d(1 - a - b - 2 * third, a + third, b + third); });
    }
  }
}

}  // namespace lobe
