// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "lobe_mesh/label_grid.h"
#include "lobe_mesh/lines.h"

namespace lobe::meshing {
namespace {

using Cell = std::array<Index, 3>;

// Where the interface crosses the edge from one voxel to the next, as a part of the edge.
double crossing(const LabelGrid& grid, std::size_t from, std::size_t to) {
  const double a = static_cast<double>(grid.margins[from]), b = static_cast<double>(grid.margins[to]);
  return a / (a + b);
}

// The mean of the crossings on the edges of a cube of voxels [grid coordinates]; false if there are none.
bool dual_vertex(const LabelGrid& grid, const Cell& cell, Vec3d& vertex) {
  Vec3d sum = Vec3d::Zero();
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 4; ++side) {
      Cell from = cell;
      from[(axis + 1) % 3] += side & 1;
      from[(axis + 2) % 3] += side >> 1;
      Cell to = from;
      ++to[axis];
      const std::size_t a = grid.index(from[0], from[1], from[2]), b = grid.index(to[0], to[1], to[2]);
      if (grid.regions[a] == grid.regions[b]) continue;
      sum += Vec3d(from[0], from[1], from[2]) + crossing(grid, a, b) * Vec3d::Unit(axis);
      ++count;
    }
  }
  if (count > 0) vertex = sum / count;
  return count > 0;
}

// A surface that is built triangle by triangle.
struct Patch {
  std::map<Index, Index> number;  // of a vertex of the whole in this patch
  std::vector<Vec3d> points;
  std::vector<std::array<Index, 3>> triangles;

  Index add(Index vertex, const Vec3d& point) {
    const auto [entry, is_new] = number.try_emplace(vertex, static_cast<Index>(points.size()));
    if (is_new) points.push_back(point);
    return entry->second;
  }
  Surface surface() const {
    Surface surface{Mat3X<double>(3, points.size()), Triangles(3, triangles.size())};
    for (std::size_t i = 0; i < points.size(); ++i) surface.points.col(i) = points[i];
    for (std::size_t t = 0; t < triangles.size(); ++t)
      surface.triangles.col(t) << triangles[t][0], triangles[t][1], triangles[t][2];
    return surface;
  }
};

class Contour {
 public:
  explicit Contour(const LabelGrid& grid)
      : grid_(grid),
        vertex_of_(grid.regions.size(), -1),
        mirrored_(grid.to_world.leftCols<3>().determinant() < 0) {
    for_each_cell([&](const Cell& cell) { add_vertex(cell); });
    for_each_cell([&](const Cell& cell) {
      for (int axis = 0; axis < 3; ++axis) {
        add_square(cell, axis);
        add_junction(cell, axis);
      }
    });
  }
  const std::map<std::pair<int, int>, Patch>& patches() const { return patches_; }

  std::vector<Mat3X<double>> junctions() const {
    std::vector<Mat3X<double>> lines;
    for (const Polyline& line : lines_of(junction_edges_)) {
      Mat3X<double>& points = lines.emplace_back(3, line.size());
      for (std::size_t i = 0; i < line.size(); ++i) points.col(i) = points_[line[i]];
      smooth(points);
    }
    return lines;
  }

 private:
  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    for (Index k = 0; k + 1 < grid_.size[2]; ++k)
      for (Index j = 0; j + 1 < grid_.size[1]; ++j)
        for (Index i = 0; i + 1 < grid_.size[0]; ++i) visit(Cell{i, j, k});
  }
  int region(const Cell& c) const { return grid_.regions[grid_.index(c[0], c[1], c[2])]; }

  void add_vertex(const Cell& cell) {
    Vec3d at;
    if (!dual_vertex(grid_, cell, at)) return;
    vertex_of_[grid_.index(cell[0], cell[1], cell[2])] = static_cast<Index>(points_.size());
    points_.push_back(grid_.to_world.leftCols<3>() * at + grid_.to_world.col(3));
  }

  // An edge between two regions belongs to four cubes. Their vertices make a square that the edge pierces.
  void add_square(const Cell& from, int axis) {
    Cell to = from;
    ++to[axis];
    const int a = region(from), b = region(to);
    if (a == b) return;
    Patch& patch = patches_[std::minmax(a, b)];
    std::array<Index, 4> corners{};
    for (int c = 0; c < 4; ++c) {  // counter-clockwise about the edge
      Cell cube = from;
      cube[(axis + 1) % 3] -= c == 0 || c == 3 ? 1 : 0;
      cube[(axis + 2) % 3] -= c < 2 ? 1 : 0;
      const Index vertex = vertex_of_[grid_.index(cube[0], cube[1], cube[2])];
      corners[c] = patch.add(vertex, points_[vertex]);
    }
    if ((a < b) != mirrored_) std::swap(corners[1], corners[3]);  // seen from outside of the larger
    patch.triangles.push_back({corners[0], corners[1], corners[2]});
    patch.triangles.push_back({corners[0], corners[2], corners[3]});
  }

  // Joins the cubes on both sides of a square of four voxels, if these have three or more regions.
  void add_junction(const Cell& cube, int axis) {
    Cell before = cube;
    if (--before[axis] < 0) return;
    std::array<int, 4> regions{};
    for (int c = 0; c < 4; ++c) {
      Cell voxel = cube;
      voxel[(axis + 1) % 3] += c & 1;
      voxel[(axis + 2) % 3] += c >> 1;
      regions[c] = region(voxel);
    }
    // If equal regions lie across from each other, either no line pierces the square, or two lines do.
    if (regions[0] == regions[3] || regions[1] == regions[2]) return;
    std::sort(regions.begin(), regions.end());
    if (std::unique(regions.begin(), regions.end()) - regions.begin() < 3) return;
    junction_edges_.emplace_back(vertex_of_[grid_.index(before[0], before[1], before[2])],
                                 vertex_of_[grid_.index(cube[0], cube[1], cube[2])]);
  }

  // Smooths the steps between voxels. The ends of a line stay.
  static void smooth(Mat3X<double>& line) {
    constexpr int rounds = 10;
    for (int round = 0; round < rounds; ++round) {
      const Mat3X<double> old = line;
      for (Eigen::Index i = 1; i + 1 < line.cols(); ++i)
        line.col(i) = (old.col(i - 1) + 2 * old.col(i) + old.col(i + 1)) / 4;
    }
  }

  const LabelGrid& grid_;
  std::vector<Index> vertex_of_;  // of the cube whose first corner is this voxel
  bool mirrored_;
  std::vector<Vec3d> points_;
  std::map<std::pair<int, int>, Patch> patches_;
  std::vector<std::pair<Index, Index>> junction_edges_;
};

}  // namespace

LabelSurfaces label_surfaces(const LabelGrid& grid) {
  const Contour contour(grid);
  LabelSurfaces result;
  for (const auto& [pair, patch] : contour.patches()) {
    result.surfaces.push_back(patch.surface());
    result.sides.push_back({pair.second - 1, pair.first - 1});
  }
  result.junctions = contour.junctions();
  return result;
}

}  // namespace lobe::meshing
