#include "lobe/cut/distance.h"

#include <doctest/doctest.h>

#include <random>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("the distance to a tetrahedron is 0 inside and exact over faces, edges and vertices") {
  Mat34<double> x;
  x << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  CHECK(distance_to_tet({0.1, 0.1, 0.1}, x) == 0);
  CHECK(distance_to_tet({0.2, 0.2, -0.5}, x) == near(0.5, 1e-12));
  CHECK(distance_to_tet({0.5, -0.3, -0.4}, x) == near(0.5, 1e-12));
  CHECK(distance_to_tet({-1, -2, -2}, x) == near(3, 1e-12));
  CHECK(distance_to_tet({1, 1, 1}, x) == near(2 / std::sqrt(3.0), 1e-12));
  x.col(0).swap(x.col(1));  // inverted
  CHECK(distance_to_tet({0.1, 0.1, 0.1}, x) == 0);
  CHECK(distance_to_tet({0.2, 0.2, -0.5}, x) == near(0.5, 1e-12));
}

TEST_CASE("the nearest point on a triangle is nearer than any sampled one") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vec3d(uniform(random), uniform(random), uniform(random)); };
  for (int i = 0; i < 200; ++i) {
    const Vec3d a = point(), b = point(), c = point(), p = point();
    const double nearest = (nearest_on_triangle(p, a, b, c) - p).norm();
    double sampled = 1e9;
    for (int s = 0; s <= 40; ++s)
      for (int t = 0; s + t <= 40; ++t)
        sampled = std::min(sampled, (a + (b - a) * s / 40. + (c - a) * t / 40. - p).norm());
    CHECK(nearest <= sampled + 1e-12);
    CHECK(nearest > sampled - 0.1);
  }
}
