// A sheet is what a cutting edge sweeps in one step: a strip of triangles.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class Sheet {
 public:
  // Between two rows of as many points each [m]: where the edge was, and where it is.
  Sheet(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

  const Eigen::AlignedBox3d& box() const { return box_; }  // [m]
  double distance(const Vec3d& p) const;                   // [m]
  // Whether a tetrahedron may be within a distance of the sheet [m]. It is not, if a plane separates them, or
  // if it is further from all boxes around parts of the sheet.
  bool may_reach(const Mat34<double>& x, double reach) const;
  // Where the sheet crosses the edge from p to q, as a share of it: where it pierces an odd number of
  // triangles, at the first. Nothing where both ends are on one side.
  std::optional<double> crossing(const Vec3d& p, const Vec3d& q) const;

 private:
  struct Triangle {
    std::array<Vec3d, 3> corners;
    Eigen::AlignedBox3d box;
  };
  struct Part {  // triangles in a row
    std::size_t begin, end;
    Eigen::AlignedBox3d box;
  };
  std::vector<Triangle> triangles_;
  std::vector<Part> parts_;
  Vec3d normal_ = Vec3d::Zero();  // the mean of the triangles'
  double low_ = 0, high_ = 0;     // along it [m]
  Eigen::AlignedBox3d box_;
};

}  // namespace lobe
