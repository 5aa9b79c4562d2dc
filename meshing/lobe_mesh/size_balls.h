// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Balls in which shorter edges are asked for, and how they are read from a file.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// The minimum of edge + growth × distance over all balls; by a tree of boxes, O(log #balls) per point.
class SizeBalls {
 public:
  SizeBalls(std::vector<SizeBall> balls, double growth);

  double at(const Vec3d& point, double edge) const;  // [m] at most `edge`

 private:
  struct Node {
    Eigen::AlignedBox3d centres;
    double shortest = 0, least = 0;  // [m] edge; edge − growth × radius
    std::size_t begin = 0, end = 0;  // range in the balls
    std::size_t right = 0;           // its left child is the next node; 0: a leaf
  };
  void build(std::size_t begin, std::size_t end);
  void lower(const Vec3d& point, std::size_t node, double& edge) const;

  std::vector<SizeBall> balls_;
  std::vector<Node> nodes_;
  double growth_ = 0;
};

// The point array `edge` [m] of a tetrahedral mesh (.vtu): each vertex asks for its edge in a ball of the
// volume around it, a quarter of that of its tetrahedra. Throws InputError if the array is missing, or not of
// positive numbers.
std::vector<SizeBall> read_size_balls(const std::filesystem::path& file);

}  // namespace lobe::meshing
