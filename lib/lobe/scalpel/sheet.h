// A sheet is what a cutting edge sweeps in one step: a strip of triangles.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class Sheet {
 public:
  // Takes two rows of as many points each [m]: where the edge was, and where it is.
  Sheet(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

  const Eigen::AlignedBox3d& box() const { return box_; }  // [m]
  double distance(const Vec3d& p, double within) const;    // [m]; infinite where it is above that
  // Whether a tetrahedron may be within a distance of the sheet [m]. It is not, if it is further from the box
  // around the sheet along one of the axes of that, or from all boxes around parts of the sheet.
  bool may_reach(const Mat34<double>& x, double reach) const;
  bool may_reach(const Eigen::AlignedBox3d& box, double reach) const;  // `box`: the other one [m]
  // Says beyond which of two planes, between which the sheet lies, a point is: −1 or 1; 0: neither. An edge
  // from one such point to another beyond the same plane is not crossed.
  int side(const Vec3d& p) const {
    const double at = axes_.row(0).dot(p);
    return at < low_[0] - rounding_ ? -1 : at > high_[0] + rounding_ ? 1 : 0;
  }
  // The distance of a point from these planes, no larger than that from the sheet [m].
  double beyond(const Vec3d& p) const {
    const double at = axes_.row(0).dot(p);
    return std::max(low_[0] - at, at - high_[0]) - rounding_;
  }
  // Where the sheet crosses the edge from p to q, as a share of it: where it pierces an odd number of
  // triangles, at the first. Nothing where both ends are on one side.
  std::optional<double> crossing(const Vec3d& p, const Vec3d& q) const;

 private:
  void find_box(const Vec3d& normal, const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

  struct Triangle {
    std::array<Vec3d, 3> corners;
    Eigen::AlignedBox3d box;
  };
  struct Part {  // a row of triangles, or of parts
    std::size_t begin, end;
    Eigen::AlignedBox3d box;
  };
  static constexpr std::size_t per_part = 4;
  // Boxes whose distances to another one are found together. Boxes that are not there are infinitely far.
  struct BoxesOfParts {
    explicit BoxesOfParts(std::span<const Part> parts) {
      for (int d = 0; d < 3; ++d)
        for (std::size_t i = 0; i < per_part; ++i) {
          low[d][i] = i < parts.size() ? parts[i].box.min()[d] : std::numeric_limits<double>::infinity();
          high[d][i] = i < parts.size() ? parts[i].box.max()[d] : -std::numeric_limits<double>::infinity();
        }
    }
    std::array<double, per_part> squared_distances(const Eigen::AlignedBox3d& box) const {
      std::array<double, per_part> squares{};
      for (int d = 0; d < 3; ++d)
        for (std::size_t i = 0; i < per_part; ++i) {
          const double apart = std::max(std::max(low[d][i] - box.max()[d], box.min()[d] - high[d][i]), 0.0);
          squares[i] += apart * apart;
        }
      return squares;
    }
    std::array<std::array<double, per_part>, 3> low, high;
  };
  template <class Visit>  // visit(part): parts whose box is as near as that, until it returns true
  bool visit_parts(const Eigen::AlignedBox3d& box, double square, Visit&& visit) const {
    for (std::size_t at = 0; at < groups_.size(); at += per_part) {
      const std::array<double, per_part> of_groups = of_groups_[at / per_part].squared_distances(box);
      for (std::size_t g = at; g < std::min(at + per_part, groups_.size()); ++g) {
        if (of_groups[g - at] > square) continue;
        const std::array<double, per_part> of_parts = of_parts_[g].squared_distances(box);
        for (std::size_t i = groups_[g].begin; i < groups_[g].end; ++i)
          if (of_parts[i - groups_[g].begin] <= square && visit(parts_[i])) return true;
      }
    }
    return false;
  }
  std::vector<Triangle> triangles_;
  std::vector<Part> parts_, groups_;                // parts of triangles, and groups of parts
  std::vector<BoxesOfParts> of_parts_, of_groups_;  // the parts of each group; groups in fours
  // Axes of a box around the sheet: the mean of the triangles' normals, across the edge, along it. Zero where
  // there is no normal.
  Mat3<double> axes_ = Mat3<double>::Zero();
  Vec3d low_, high_;        // bounds along these axes [m]
  double rounding_ = 0;     // a bound of the rounding of low_ and high_ [m]
  bool fills_box_ = false;  // its box is as full as those of its parts: there is no need to look at them
  Eigen::AlignedBox3d box_;
};

// Where the first sheet that crosses the edge from p to q does so, as a share of the edge.
std::optional<double> first_crossing(std::span<const Sheet* const> sheets, const Vec3d& p, const Vec3d& q);

// What a stroke has swept last: sheets between rows of points, one after the other. Rows and sheets are made
// when they are asked for. Most of the time nothing is near any but the last.
class SweptSheets {
 public:
  using Row = std::vector<Vec3d>;  // row of points, as many as in the others [m]

  // Rows that come before all that are added: find(i) gives the i-th of them.
  void begin_with(std::size_t rows, std::function<Row(std::size_t)> find) {
    rows_.resize(rows);
    find_ = std::move(find);
  }
  void add(Row row) { rows_.emplace_back(std::move(row)); }
  void clear() { *this = {}; }

  const Row& row(std::size_t i) const {
    if (!rows_[i]) rows_[i] = find_(i);
    return *rows_[i];
  }
  const Sheet& last() const { return sheet(rows_.size() - 2); }
  const Sheet* before_last() const { return rows_.size() > 2 ? &sheet(rows_.size() - 3) : nullptr; }
  std::vector<const Sheet*> all() const;                                     // sheets, the last one first
  Eigen::AlignedBox3d last_box() const { return box_of(rows_.size() - 2); }  // around the last sheet [m]
  // Whether any sheet is nearer to a point than that [m].
  bool is_near(const Vec3d& p, double within) const;

 private:
  const Sheet& sheet(std::size_t i) const;  // sheet between the rows i and i + 1
  Eigen::AlignedBox3d box_of(std::size_t sheet) const { return row_box(sheet).merged(row_box(sheet + 1)); }
  const Eigen::AlignedBox3d& row_box(std::size_t i) const;

  mutable std::deque<std::optional<Row>> rows_;
  std::function<Row(std::size_t)> find_;
  mutable std::vector<Eigen::AlignedBox3d> boxes_;  // around each row; empty ones are not known yet
  mutable std::deque<std::optional<Sheet>> sheets_;
};

}  // namespace lobe
