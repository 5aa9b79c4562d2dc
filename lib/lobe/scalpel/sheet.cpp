#include "lobe/scalpel/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/scalpel/orientation.h"

namespace lobe {
namespace {

bool separates(const std::array<Vec3d, 3>& t, const Vec3d& p, const Vec3d& q) {
  return side_of_plane(t[0], t[1], t[2], p) * side_of_plane(t[0], t[1], t[2], q) < 0;
}

bool is_pierced(const std::array<Vec3d, 3>& t, const Vec3d& p, const Vec3d& q) {
  const int side = side_of_line(t[0], t[1], p, q);
  return side == side_of_line(t[1], t[2], p, q) && side == side_of_line(t[2], t[0], p, q);
}

double share_at(const std::array<Vec3d, 3>& t, const Vec3d& p, const Vec3d& q) {
  const Vec3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double at_p = std::abs(normal.dot(p - t[0])), at_q = std::abs(normal.dot(q - t[0]));
  return at_p + at_q > 0 ? at_p / (at_p + at_q) : 0.5;
}

}  // namespace

Sheet::Sheet(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
  Vec3d normal = Vec3d::Zero();
  triangles_.reserve(2 * from.size());
  for (std::size_t i = 0; i + 1 < from.size(); ++i)
    for (const std::array<Vec3d, 3>& t : {std::array<Vec3d, 3>{from[i], from[i + 1], to[i + 1]},
                                          std::array<Vec3d, 3>{from[i], to[i + 1], to[i]}}) {
      Triangle& triangle = triangles_.emplace_back(Triangle{t, {}});
      for (const Vec3d& corner : t) triangle.box.extend(corner);
      box_.extend(triangle.box);
      normal += (t[1] - t[0]).cross(t[2] - t[0]);
    }
  find_box(normal, from, to);
  parts_.reserve(triangles_.size() / per_part + 1);
  for (std::size_t begin = 0; begin < triangles_.size(); begin += per_part) {
    Part& part = parts_.emplace_back(Part{begin, std::min(begin + per_part, triangles_.size()), {}});
    for (std::size_t i = begin; i < part.end; ++i) part.box.extend(triangles_[i].box);
  }
  for (std::size_t begin = 0; begin < parts_.size(); begin += per_part) {
    Part& group = groups_.emplace_back(Part{begin, std::min(begin + per_part, parts_.size()), {}});
    for (std::size_t i = begin; i < group.end; ++i) group.box.extend(parts_[i].box);
    of_parts_.emplace_back(std::span(parts_).subspan(begin, group.end - begin));
  }
  for (std::size_t begin = 0; begin < groups_.size(); begin += per_part)
    of_groups_.emplace_back(std::span(groups_).subspan(begin, std::min(per_part, groups_.size() - begin)));
}

void Sheet::find_box(const Vec3d& normal, const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
  constexpr double loose = 1.5;  // times the longest way of a point: a box that is wider is not filled
  if (const Vec3d across = normal.cross(from.back() - from.front()); across.squaredNorm() > 0) {
    axes_.row(0) = normal.normalized();
    axes_.row(1) = across.normalized();
    axes_.row(2) = axes_.row(0).cross(axes_.row(1));
  }
  low_.setConstant(std::numeric_limits<double>::infinity());
  high_ = -low_;
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    longest = std::max(longest, (to[i] - from[i]).norm());
    for (const Vec3d& p : {from[i], to[i]}) {
      const Vec3d at = axes_ * p;
      low_ = low_.cwiseMin(at);
      high_ = high_.cwiseMax(at);
      rounding_ = std::max(rounding_, 1e-12 * p.cwiseAbs().maxCoeff());
    }
  }
  const Vec3d size = high_ - low_;
  fills_box_ = size[1] > 0 && size[0] + size[1] <= loose * longest;
}

bool Sheet::may_reach(const Mat34<double>& x, double reach) const {
  const double within = reach + rounding_;
  for (int d = 0; d < 3; ++d) {
    const Eigen::RowVector4d at = axes_.row(d) * x;
    if (at.maxCoeff() < low_[d] - within || at.minCoeff() > high_[d] + within) return false;
  }
  return fills_box_ || visit_parts({x.rowwise().minCoeff(), x.rowwise().maxCoeff()}, within * within,
                                   [](const Part&) { return true; });
}

bool Sheet::may_reach(const Eigen::AlignedBox3d& box, double reach) const {
  const double within = reach + rounding_;
  const Vec3d middle = (box.min() + box.max()) / 2, half = (box.max() - box.min()) / 2;
  for (int d = 0; d < 3; ++d) {
    const Vec3d axis = axes_.row(d);
    const double at = axis.dot(middle), around = axis.cwiseAbs().dot(half) + within;
    if (at + around < low_[d] || at - around > high_[d]) return false;
  }
  return fills_box_ || visit_parts(box, within * within, [](const Part&) { return true; });
}

double Sheet::distance(const Vec3d& p, double within) const {
  double square = (1 + 1e-15) * within * within;  // whether it is below is for the caller to say
  bool is_within = false;
  for (const Part& group : groups_) {
    if (group.box.squaredExteriorDistance(p) >= square) continue;
    for (std::size_t at = group.begin; at < group.end; ++at) {
      const Part& part = parts_[at];
      if (part.box.squaredExteriorDistance(p) >= square) continue;
      for (std::size_t i = part.begin; i < part.end; ++i) {
        const Triangle& t = triangles_[i];
        if (t.box.squaredExteriorDistance(p) >= square) continue;
        const Vec3d nearest = nearest_on_triangle(p, t.corners[0], t.corners[1], t.corners[2]);
        const double own = (p - nearest).squaredNorm();
        if (own >= square) continue;
        square = own;
        is_within = true;
      }
    }
  }
  return is_within ? std::sqrt(square) : std::numeric_limits<double>::infinity();
}

std::optional<double> Sheet::crossing(const Vec3d& p, const Vec3d& q) const {
  Eigen::AlignedBox3d edge(p.cwiseMin(q), p.cwiseMax(q));
  std::optional<double> first;
  int count = 0;
  visit_parts(edge, 0, [&](const Part& part) {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const Triangle& t = triangles_[i];
      if (!t.box.intersects(edge) || !separates(t.corners, p, q) || !is_pierced(t.corners, p, q)) continue;
      const double share = share_at(t.corners, p, q);
      first = first ? std::min(*first, share) : share;
      ++count;
    }
    return false;
  });
  return count % 2 == 1 ? first : std::nullopt;
}

std::optional<double> first_crossing(std::span<const Sheet* const> sheets, const Vec3d& p, const Vec3d& q) {
  for (const Sheet* sheet : sheets)
    if (const std::optional<double> share = sheet->crossing(p, q)) return share;
  return {};
}

const Eigen::AlignedBox3d& SweptSheets::row_box(std::size_t i) const {
  if (boxes_.size() < rows_.size()) boxes_.resize(rows_.size());
  Eigen::AlignedBox3d& box = boxes_[i];
  if (box.isEmpty())
    for (const Vec3d& p : row(i)) box.extend(p);
  return box;
}

const Sheet& SweptSheets::sheet(std::size_t i) const {
  if (sheets_.size() <= i) sheets_.resize(rows_.size() - 1);
  std::optional<Sheet>& sheet = sheets_[i];
  if (!sheet) sheet.emplace(row(i), row(i + 1));
  return *sheet;
}

std::vector<const Sheet*> SweptSheets::all() const {
  std::vector<const Sheet*> sheets;
  for (std::size_t i = rows_.size() - 1; i-- > 0;) sheets.push_back(&sheet(i));
  return sheets;
}

bool SweptSheets::is_near(const Vec3d& p, double within) const {
  for (std::size_t i = rows_.size() - 1; i-- > 0;)
    if (box_of(i).squaredExteriorDistance(p) < within * within && sheet(i).distance(p, within) < within)
      return true;
  return false;
}

}  // namespace lobe
