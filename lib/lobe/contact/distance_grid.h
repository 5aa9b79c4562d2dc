// The signed distance to a closed triangle mesh, found once at the points of a grid, and trilinear between
// them: a query costs the same however many triangles there are. The sign is that of the angle-weighted
// pseudonormal at the nearest point (Bærentzen and Aanæs, IEEE TVCG 11(3), 2005).
#pragma once

#include <array>

#include "lobe/contact/signed_distance.h"

namespace lobe {

// The nearest triangle of a mesh, by a tree of bounding boxes: exact, for building the grid.
class NearestTriangle {
 public:
  NearestTriangle(const std::vector<Vec3d>& points, const std::vector<Eigen::Vector3i>& triangles);
  double signed_distance(const Vec3d& x) const;  // [m]

 private:
  struct Node {
    Vec3d low, high;
    int first = 0, count = 0;  // range of a leaf in order_; a count of 0: the node has children
    int left = -1, right = -1;
  };
  struct Nearest {
    double square = 0;
    int triangle = -1;
    Vec3d point = Vec3d::Zero();
  };
  int build(int first, int count);
  void search(int node, const Vec3d& x, Nearest& best) const;
  Vec3d normal_at(const Nearest& nearest) const;

  const std::vector<Vec3d>& points_;
  const std::vector<Eigen::Vector3i>& triangles_;
  std::vector<Vec3d> centres_, face_normals_, point_normals_;
  std::vector<std::array<Vec3d, 3>> edge_normals_;  // normals of a triangle's edges from corner i to i + 1
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

class DistanceGrid {
 public:
  static constexpr int cells = 64;  // along the longest edge of the mesh's bounding box

  // O(cells³ log #triangles): a tenth of a second and more.
  DistanceGrid(const std::vector<Vec3d>& points, const std::vector<Eigen::Vector3i>& triangles);

  // Inside the grid the distance and its gradient are trilinear. The grid reaches two cells beyond the mesh.
  // Outside of it the value is a lower bound of the distance, which shows that nothing touches.
  Distance at(const Vec3d& x) const;
  double cell() const { return cell_; }  // [m]

 private:
  double value(int i, int j, int k) const {
    return values_[std::size_t(i + count_[0] * (j + count_[1] * k))];
  }

  Vec3d low_, high_;
  double cell_;
  Eigen::Vector3i count_;  // number of points along each axis
  std::vector<double> values_;
};

}  // namespace lobe
