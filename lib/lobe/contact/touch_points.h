// The points of a triangle (quadrature.h) side by side, as kernels read them.
#pragma once

#include <array>
#include <vector>

namespace lobe {

// A point lies `along` steps of 1/n of the first edge and `up` steps of the second from the first centroid.
struct alignas(64) PointBlock {
  static constexpr int width = 8;
  using Row = std::array<double, std::size_t(width)>;

  std::array<Row, 3> weights{};  // weights of the corners
  Row along{}, up{};
  Row turned{};            // 1: the centroid of a triangle that is turned, else 0
  int most_along = 0;      // largest `along` of its points
  unsigned int lanes = 0;  // bits of the lanes that are points; other lanes repeat the last
};

inline constexpr int most_divisions = 24;  // parts of an edge

// Returns all n² centroids in the order of visit_centroids(). They are made once.
const std::vector<PointBlock>& point_blocks(int n);

// Numbers of the points along the first edge, j steps up.
struct Strip {
  int begin, end;
};
inline Strip strip(int n, int j) { return {j * (2 * n - j), (j + 1) * (2 * n - j - 1)}; }

}  // namespace lobe
