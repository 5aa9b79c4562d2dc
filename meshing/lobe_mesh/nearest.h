// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <memory>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// Finds the nearest point of a surface in O(log #triangles). Triangles without area are left out.
class NearestPoint {
 public:
  explicit NearestPoint(const Surface& surface);
  ~NearestPoint();
  NearestPoint(NearestPoint&&) noexcept;

  Vec3d operator()(const Vec3d& point) const;
  double distance(const Vec3d& point) const { return ((*this)(point)-point).norm(); }

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// Largest distance from vertices and centres of triangles of one surface to the other, both ways.
double sampled_distance(const Surface& a, const Surface& b);

}  // namespace lobe::meshing
