#include "lobe/scalpel/orientation.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "lobe/mesh/generators.h"
#include "lobe/scalpel/sheet.h"

using namespace lobe;

TEST_CASE("the sign is that of integer determinants, which are exact") {
  std::mt19937 random(1);
  std::uniform_int_distribution<long> whole(-100, 100);
  int ties = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    long p[4][3];
    for (auto& point : p)
      for (long& x : point) x = whole(random) / 40;  // few values: many ties
    const auto at = [&](int i, int k) { return p[i][k] - p[3][k]; };
    const long det = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                     at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                     at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
    // A scale and a shift by powers of two change no sign; the shift spoils the digits of differences.
    const auto point = [&](int i) -> Vec3d {
      return Vec3d(p[i][0], p[i][1], p[i][2]) * 0x1p-30 + Vec3d::Ones();
    };
    ties += det == 0;
    CHECK(orientation(point(0), point(1), point(2), point(3)) == (det > 0) - (det < 0));
  }
  CHECK(ties > 1000);
}

TEST_CASE("one unit in the last place off a plane is seen") {
  const Vec3d a(0.1, 0.2, 0.3), b(1.1, 0.2, 0.3), c(0.1, 1.2, 0.3);
  const double up = std::nextafter(0.3, 1), down = std::nextafter(0.3, 0);
  CHECK(orientation(a, b, c, {0.4, 0.4, 0.3}) == 0);
  CHECK(orientation(a, b, c, {0.4, 0.4, up}) == -orientation(a, b, c, {0.4, 0.4, down}));
  CHECK(orientation(a, b, c, {0.4, 0.4, up}) != 0);
}

TEST_CASE("a line through the edge that two triangles share pierces one of them") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const double s = trial % 3 == 0 ? 0.5 : uniform(random);
    const std::vector<Vec3d> from{{0, 0, 0}, {1, 0, 0}}, to{{0, 1, 0}, {1, 1, 0}};  // diagonal x = y
    const Vec3d p(s, s, -1), q(s, s, 1);
    CHECK(Sheet(from, to).crossing(p, q).has_value() == (s > 0 && s < 1));
    CHECK(Sheet(from, to).crossing(q, p).has_value() == (s > 0 && s < 1));
  }
}

TEST_CASE("a sheet tells where it is crossed, and how far a point is from it") {
  const Sheet sheet({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {0.5, 1, 0}, {1, 1, 0}});
  CHECK(*sheet.crossing({0.3, 0.4, -1}, {0.3, 0.4, 3}) == 0.25);
  CHECK(!sheet.crossing({0.3, 0.4, 1}, {0.3, 0.4, 3}));
  CHECK(!sheet.crossing({1.3, 0.4, -1}, {1.3, 0.4, 3}));
  CHECK(sheet.distance({0.7, 0.2, 0.5}, 2) == 0.5);
  CHECK(sheet.distance({1, 2, 0}, 2) == 1);
  CHECK(sheet.distance({1, 2, 0}, 0.99) > 1);  // farther than it asks for
}

TEST_CASE("no tetrahedron or box within reach of a sheet is said to be out of it") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vec3d(uniform(random), uniform(random), uniform(random)); };
  int in_reach = 0, out = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3d edge = any(), way = 0.2 * any(), start = any(), bend = trial % 2 * 0.3 * any();
    std::vector<Vec3d> from, to;
    for (int i = 0; i <= 10; ++i) {
      const double share = i / 10.0;
      from.push_back(start + share * edge + share * (1 - share) * bend);
      to.push_back(from.back() + way + (trial % 3 == 0 ? share : 0.0) * any());
    }
    const Sheet sheet(from, to);
    for (int tet = 0; tet < 20; ++tet) {
      const Vec3d corner = any();
      Mat34<double> x;
      for (int k = 0; k < 4; ++k) x.col(k) = corner + 0.1 * any();
      const double reach = 0.05 + 0.05 * uniform(random);
      double least = sheet.distance(x.rowwise().mean(), 10);
      for (int k = 0; k < 4; ++k) least = std::min(least, sheet.distance(x.col(k), 10));
      const bool reaches = sheet.may_reach(x, reach),
                 box_reaches = sheet.may_reach(
                     Eigen::AlignedBox3d(x.rowwise().minCoeff(), x.rowwise().maxCoeff()), reach);
      if (least < reach) {
        ++in_reach;
        CHECK(reaches);
        CHECK(box_reaches);
      }
      out += !reaches;
    }
  }
  CHECK(in_reach > 100);
  CHECK(out > 10000);
}
