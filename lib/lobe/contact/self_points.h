// Where the vertices of a boundary layer and the points of its surface are at one moment, and pairs of a
// triangle and a tetrahedron between them.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "lobe/contact/gap_kernels.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

inline constexpr int self_divisions = 3;  // parts of each edge of a triangle, at most
inline constexpr int most_self_points = self_divisions * self_divisions;

// Barycentric coordinates of the points of a triangle whose edges are divided so often.
inline const std::vector<Vec3d>& self_point_weights(int divisions) {
  static const auto weights = [] {
    std::array<std::vector<Vec3d>, self_divisions + 1> found;
    for (int n = 1; n <= self_divisions; ++n)
      visit_centroids(n, [&](int, const Vec3d& own) { found[std::size_t(n)].push_back(own); });
    return found;
  }();
  return weights[std::size_t(divisions)];
}

// The triangle between the outermost points of one of these corners.
inline Mat3<double> outermost(const Mat3<double>& corners) {
  const Vec3d centre = corners.rowwise().mean();
  return ((1 - 1.0 / self_divisions) * (corners.colwise() - centre)).colwise() + centre;
}

// Places of vertices, then of points of the surface that are no vertices.
struct SelfPoints {
  struct Between {       // a point that is no vertex
    Eigen::Vector4i of;  // places of vertices
    Eigen::Vector4d weights;
    template <class Number>  // four numbers per place, of which the last stays as it is
    void find(const Number* rows, Number* own) const {
      for (int d = 0; d < 3; ++d) {
        own[d] = 0;
        for (int c = 0; c < 4; ++c) own[d] += Number(weights[c]) * rows[std::size_t(4 * of[c] + d)];
      }
    }
  };

  std::vector<Index> vertices;   // numbers in the mesh
  std::vector<Between> between;  // points behind them
  std::vector<float> x;          // four numbers each, about the first vertex of the boundary layer [m]

  int count() const { return static_cast<int>(vertices.size() + between.size()); }
  void fit() { x.resize(4 * (vertices.size() + between.size())); }
  void find_between() {
    float* to = x.data() + 4 * vertices.size();
    for (const Between& own : between) {
      own.find(x.data(), to);
      to += 4;
    }
  }
  Vec3d at(int place) const {
    return Eigen::Map<const Vec3<float>>(x.data() + 4 * std::size_t(place)).cast<double>();
  }
};

// ---- Pairs in blocks

struct PairCorners {
  Mat3<double> triangle;
  Mat34<double> tet;
};

inline PairCorners corners_in(const SelfPoints& points, const PairBlock& block, std::size_t lane) {
  PairCorners found;
  for (int c = 0; c < 7; ++c) {
    const Vec3d x = points.at(block.places[std::size_t(c)][lane]);
    if (c < 3)
      found.triangle.col(c) = x;
    else
      found.tet.col(c - 3) = x;
  }
  return found;
}

// The normal of a pair along a way in the world. It stays as it is where the tetrahedron is flat.
inline void set_normal(const PairCorners& corners, const Vec3d& way, PairBlock& block, std::size_t lane) {
  const Vec3d normal = (corners.tet.rightCols<3>().colwise() - corners.tet.col(0)).transpose() * way;
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  for (int d = 0; d < 3; ++d) block.normal[std::size_t(d)][lane] = static_cast<float>(normal[d] / length);
}

inline void copy_lane(const PairBlock& from, std::size_t lane, PairBlock& to, std::size_t at) {
  for (std::size_t c = 0; c < 7; ++c) to.places[c][at] = from.places[c][lane];
  for (std::size_t d = 0; d < 3; ++d) to.normal[d][at] = from.normal[d][lane];
}

// Finds the gaps of the first `pairs` pairs in the blocks.
inline void find_gaps(const GapKernels& kernels, const SelfPoints& points, std::vector<PairBlock>& blocks,
                      std::size_t pairs) {
  const std::size_t width = PairBlock::width;
  kernels.find_gaps(points.x.data(), 1 - 1.0F / self_divisions, blocks.data(),
                    int((pairs + width - 1) / width));
}

}  // namespace lobe
