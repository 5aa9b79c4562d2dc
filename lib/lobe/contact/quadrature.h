// The points of a triangle at which contact is evaluated.
#pragma once

#include "lobe/types.h"

namespace lobe {

// Parallels to its edges divide a triangle into n² equal ones: visit(number, weights) of their centroids.
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

}  // namespace lobe
