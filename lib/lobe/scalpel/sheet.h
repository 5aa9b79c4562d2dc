// A sheet is what a cutting edge sweeps in one step: a strip of triangles.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class Sheet {
 public:
  // Between two rows of as many points each [m]: where the edge was, and where it is.
  Sheet(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

  const Eigen::AlignedBox3d& box() const { return box_; }  // [m]
  double distance(const Vec3d& p, double within) const;    // [m]; infinite where it is above that
  // Whether a tetrahedron may be within a distance of the sheet [m]. It is not, if a plane separates them, or
  // if it is further from all boxes around parts of the sheet.
  bool may_reach(const Mat34<double>& x, double reach) const;
  bool may_reach(const Eigen::AlignedBox3d& box, double reach) const;  // the same of a box
  // Beyond which of two planes that the sheet lies between a point is: −1 or 1; 0: between them. An edge
  // from one such point to another beyond the same plane is not crossed.
  int side(const Vec3d& p) const {
    const double at = normal_.dot(p);
    return at < low_ - rounding_ ? -1 : at > high_ + rounding_ ? 1 : 0;
  }
  // How far a point is beyond these planes: no farther than from the sheet [m].
  double beyond(const Vec3d& p) const {
    const double at = normal_.dot(p);
    return std::max(low_ - at, at - high_) - rounding_;
  }
  // Where the sheet crosses the edge from p to q, as a share of it: where it pierces an odd number of
  // triangles, at the first. Nothing where both ends are on one side.
  std::optional<double> crossing(const Vec3d& p, const Vec3d& q) const;

 private:
  struct Triangle {
    std::array<Vec3d, 3> corners;
    Eigen::AlignedBox3d box;
  };
  struct Part {  // triangles in a row; or parts
    std::size_t begin, end;
    Eigen::AlignedBox3d box;
  };
  template <class Visit>  // visit(part) of those whose box is as near as that, until it returns true
  bool visit_parts(const Eigen::AlignedBox3d& box, double square, Visit&& visit) const {
    for (const Part& group : groups_) {
      if (group.box.squaredExteriorDistance(box) > square) continue;
      for (std::size_t i = group.begin; i < group.end; ++i)
        if (parts_[i].box.squaredExteriorDistance(box) <= square && visit(parts_[i])) return true;
    }
    return false;
  }
  std::vector<Triangle> triangles_;
  std::vector<Part> parts_, groups_;  // of triangles, and of these
  Vec3d normal_ = Vec3d::Zero();      // the mean of the triangles'
  double low_ = 0, high_ = 0;         // along it [m]
  double rounding_ = 0;               // above that of these [m]
  Eigen::AlignedBox3d box_;
};

// What a stroke has swept last: sheets between rows of points, one after the other. A sheet is made when it
// is asked for. Most of the time nothing is near any but the last.
class SweptSheets {
 public:
  void add(std::vector<Vec3d> row);  // of as many points as the others [m]
  void clear() { *this = {}; }

  const Sheet& last() const { return sheet(rows_.size() - 2); }
  const Sheet* before_last() const { return rows_.size() > 2 ? &sheet(rows_.size() - 3) : nullptr; }
  // Whether a point is nearer than that to any of them [m].
  bool is_near(const Vec3d& p, double within) const;

 private:
  const Sheet& sheet(std::size_t i) const;  // between the rows i and i + 1

  std::vector<std::vector<Vec3d>> rows_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // around each
  mutable std::deque<std::optional<Sheet>> sheets_;
};

}  // namespace lobe
