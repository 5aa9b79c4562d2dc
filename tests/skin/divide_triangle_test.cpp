// Triangles of a skin along lines that run through them.
#include "lobe/skin/divide_triangle.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

bool same(Index element, Index other) { return element == other; }

Eigen::Vector2d at(const RimPoint& p) {
  static const std::array<Eigen::Vector2d, 3> corners{Eigen::Vector2d(0, 0), {2, 0}, {0.3, 1}};
  return (1 - p.share) * corners[std::size_t(p.side)] + p.share * corners[std::size_t((p.side + 1) % 3)];
}

double area(const std::vector<RimPoint>& rim, const TrianglePart& part) {
  const Eigen::Vector2d a = at(rim[std::size_t(part.points[0])]),
                        b = at(rim[std::size_t(part.points[1])]) - a,
                        c = at(rim[std::size_t(part.points[2])]) - a;
  return (b.x() * c.y() - b.y() * c.x()) / 2;
}

// Arcs have numbers from 0 on; the last goes on at corner 0.
std::vector<RimPoint> rim_of(const std::array<std::vector<double>, 3>& shares) {
  std::vector<RimPoint> rim;
  Index arc = 0;
  for (int side = 0; side < 3; ++side) {
    rim.push_back({side, 0, arc, arc});
    for (const double share : shares[std::size_t(side)]) {
      rim.push_back({side, share, arc, arc + 1});
      ++arc;
    }
  }
  for (RimPoint& p : rim) {
    if (p.before == arc) p.before = 0;
    if (p.after == arc) p.after = 0;
  }
  return rim;
}

}  // namespace

TEST_CASE("parts fill a triangle, turn as it does, and are carried by what hangs together") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    std::array<std::vector<double>, 3> shares;
    int count = 0;
    for (std::vector<double>& own : shares) {
      own.resize(random() % 3);
      for (double& share : own) share = std::uniform_real_distribution<double>(0.01, 0.99)(random);
      std::sort(own.begin(), own.end());
      count += static_cast<int>(own.size());
    }
    if (count < 2) continue;
    const std::vector<RimPoint> rim = rim_of(shares);
    double sum = 0;
    for (const TrianglePart& part : divide_triangle(rim, static_cast<Index>(trial % count), same)) {
      const double own = area(rim, part);
      CHECK(own > 0);
      sum += own;
      for (std::size_t k = 0; k < 3; ++k) CHECK(part.elements[k] == part.elements[0]);
    }
    CHECK(sum == near(1, 1e-12));
  }
}

TEST_CASE(
    "a line through two sides parts a corner from the two others; one into a side leads to the corner "
    "opposite") {
  const auto two = divide_triangle(rim_of({{{0.4}, {}, {0.7}}}), -1, same);
  REQUIRE(two.size() == 3);  // the corner alone, and two triangles of the others
  CHECK(std::count_if(two.begin(), two.end(), [](const TrianglePart& p) { return p.elements[0] == 0; }) == 1);
  std::vector<RimPoint> one_line = rim_of({{{0.5}, {}, {}}});
  one_line[1].after = 7;  // there the corners behind it are still on one side with those before
  const auto one = divide_triangle(one_line, -1, same);
  REQUIRE(one.size() == 2);
  CHECK(one[0].points == std::array<int, 3>{0, 1, 3});
  CHECK(one[1].points == std::array<int, 3>{1, 2, 3});
  CHECK(one[0].elements[1] == 0);
  CHECK(one[1].elements[0] == 7);
}

TEST_CASE("a strip between two lines takes the middle between them") {
  std::vector<RimPoint> rim = rim_of({{{0.3, 0.6}, {}, {0.4, 0.7}}});  // arcs 0: corner 0, 1 and 3: the strip
  for (RimPoint& p : rim)
    for (Index* element : {&p.before, &p.after})
      if (*element == 3) *element = 1;
  double strip = 0, sum = 0;
  for (const TrianglePart& part : divide_triangle(rim, 2, same)) {
    (part.elements[0] == 1 ? strip : sum) += area(rim, part);
    CHECK((part.elements[0] == part.elements[1] && part.elements[0] == part.elements[2]));
  }
  CHECK(strip == near(0.6 * 0.6 - 0.3 * 0.3, 1e-12));
  CHECK(sum + strip == near(1, 1e-12));
}
