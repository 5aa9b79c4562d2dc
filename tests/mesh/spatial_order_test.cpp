#include "lobe/mesh/spatial_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace lobe;

namespace {

Mat3X<double> grid(int n) {
  Mat3X<double> points(3, n * n * n);
  for (int i = 0; i < n * n * n; ++i) points.col(i) << i % n, i / n % n, i / (n * n);
  return points;
}

}  // namespace

TEST_CASE("along the curve each point of a grid is a neighbour of the one before, whatever their numbering") {
  Mat3X<double> points = grid(8);
  std::mt19937 random(1);
  for (int trial = 0; trial < 2; ++trial) {
    const std::vector<Index> order = spatial_order(points);
    REQUIRE(order.size() == 512);
    for (std::size_t i = 1; i < order.size(); ++i)
      CHECK((points.col(order[i]) - points.col(order[i - 1])).norm() == 1);
    std::vector<int> shuffled(512);
    std::iota(shuffled.begin(), shuffled.end(), 0);
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    points = points(Eigen::all, shuffled).eval();
  }
}

TEST_CASE("points that coincide keep their order, and no points have none") {
  CHECK(spatial_order(Mat3X<double>::Constant(3, 4, 0.5)) == std::vector<Index>{0, 1, 2, 3});
  CHECK(spatial_order(Mat3X<double>(3, 0)).empty());
}
