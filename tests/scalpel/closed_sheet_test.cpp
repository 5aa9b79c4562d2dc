// Sheets that enclose a volume: a segment crosses them an odd number of times if one end is inside.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>

#include "lobe/scalpel/sheet.h"

using namespace lobe;

namespace {

// A ring of eight cubes around a hole, sheared by whole numbers: it is convex nowhere, and all is exact.
class Ring {
 public:
  Ring() {
    const std::vector<Vec3d> outer{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0},
                                   {3, 2, 0}, {3, 3, 0}, {2, 3, 0}, {1, 3, 0}, {0, 3, 0},
                                   {0, 2, 0}, {0, 1, 0}, {0, 0, 0}},
        inner{{1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}};
    for (const std::vector<Vec3d>& row : {outer, inner}) add(row, Vec3d(0, 0, 1));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 2 && (i != 1 || j != 1); ++k)
          add({Vec3d(i, j, k), Vec3d(i + 1, j, k)}, Vec3d(0, 1, 0));
  }

  // Scaled so that middles of edges are whole numbers, too.
  static Vec3d at(const Vec3d& place) {
    Mat3<double> shear;
    shear << 24, 8, -4, 4, 28, 8, -8, 4, 36;
    return shear * place;
  }
  static Vec3d place_of(const Vec3d& x) {
    static const Mat3<double> back = [] {
      Mat3<double> shear;
      for (int k = 0; k < 3; ++k) shear.col(k) = at(Vec3d::Unit(k));
      return Mat3<double>(shear.inverse());
    }();
    return back * x;
  }
  // Whether x, whole numbers, is on a face or within rounding of one.
  static bool is_on(const Vec3d& x) {
    const Vec3d place = place_of(x), nudge = Vec3d::Constant(1e-9);
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      inside += holds(place + nudge.cwiseProduct(sign));
    }
    return inside != 0 && inside != 8;
  }
  static bool is_inside(const Vec3d& x) { return holds(place_of(x)); }

  int crossings(const Vec3d& p, const Vec3d& q) const {
    int count = 0;
    for (const Sheet& sheet : sheets_) count += sheet.crossing(p, q).has_value();
    return count;
  }

 private:
  static bool holds(const Vec3d& place) {
    if (place.minCoeff() < 0 || place[0] > 3 || place[1] > 3 || place[2] > 1) return false;
    return std::floor(place[0]) != 1 || std::floor(place[1]) != 1;
  }
  void add(const std::vector<Vec3d>& row, const Vec3d& way) {
    std::vector<Vec3d> from, to;
    for (const Vec3d& place : row) {
      from.push_back(at(place));
      to.push_back(at(place + way));
    }
    sheets_.emplace_back(from, to);
  }

  std::vector<Sheet> sheets_;
};

}  // namespace

TEST_CASE("a segment crosses a closed sheet an odd number of times if one end is inside") {
  const Ring ring;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int odd = 0, wrong = 0;
  for (int trial = 0; trial < 40000; ++trial) {
    const auto any = [&] {
      return Ring::at({1.5 + 2 * uniform(random), 1.5 + 2 * uniform(random), 0.5 + uniform(random)});
    };
    const Vec3d p = any(), q = any();
    const bool differ = Ring::is_inside(p) != Ring::is_inside(q);
    wrong += (ring.crossings(p, q) % 2 == 1) != differ;
    odd += differ;
  }
  CHECK(wrong == 0);
  CHECK(odd > 5000);
}

TEST_CASE("so it does where it goes exactly through edges, diagonals and vertices") {
  const Ring ring;
  std::mt19937 random(10);
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  int odd[3] = {}, wrong[3] = {};
  for (int trial = 0; trial < 60000; ++trial) {
    const int kind = trial % 3;
    Vec3d place(whole(0, 3), whole(0, 3), whole(0, 1));
    if (kind == 1) place[whole(0, 2)] += 0.5;                                       // amid an edge
    if (kind == 2) place += Vec3d::Constant(0.5) - 0.5 * Vec3d::Unit(whole(0, 2));  // amid a diagonal
    const Vec3d x = Ring::at(place), way(whole(-12, 12), whole(-12, 12), whole(-12, 12));
    const Vec3d p = x - whole(1, 3) * way, q = x + whole(1, 3) * way;
    if (way.isZero() || Ring::is_on(p) || Ring::is_on(q)) continue;
    const bool differ = Ring::is_inside(p) != Ring::is_inside(q);
    wrong[kind] += (ring.crossings(p, q) % 2 == 1) != differ;
    odd[kind] += differ;
  }
  for (int kind = 0; kind < 3; ++kind) {
    CHECK(wrong[kind] == 0);
    CHECK(odd[kind] > 3000);
  }
}
