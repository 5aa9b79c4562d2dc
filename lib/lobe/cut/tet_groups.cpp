#include "lobe/cut/tet_groups.h"

#include <algorithm>
#include <cmath>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr double group_size = 200;  // tetrahedra on average; an eighth of it in each leaf
constexpr double much = 0.1;        // of its size, by which the box of a group is wider than it need be
constexpr double much_of_leaf = 0.03;
constexpr double single_bits = 1.2e-7;  // relative rounding of single precision, and a little more

Eigen::AlignedBox3d box_around(const Mat34<double>& x) {
  return {x.rowwise().minCoeff(), x.rowwise().maxCoeff()};
}
Eigen::AlignedBox3d widened(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vec3d::Constant(by), box.max() + Vec3d::Constant(by)};
}

}  // namespace

// Cells of a grid over the body at rest, each of eight smaller ones; a tetrahedron belongs to the cell of
// its first vertex.
void TetGroups::form(const Topology& topology, const Mat3X<double>& points) {
  leaf_of_.clear();
  leaves_.clear();
  groups_.clear();
  Eigen::AlignedBox3d body;
  for (Index v = 0; v < topology.vertex_count(); ++v) body.extend(points.col(v));
  const double cells = std::max(1.0, topology.alive_count() / group_size);
  const Vec3d size = body.sizes().cwiseMax(1e-3 * body.sizes().maxCoeff());
  const double edge = std::cbrt(size.prod() / cells);
  const Eigen::Vector3i count = (size / edge).array().ceil().cast<int>().cwiseMax(1);
  const auto cell_of = [&](Index t) {
    const Eigen::Vector3i fine = ((points.col(topology.tets()(0, t)) - body.min()) / (edge / 2))
                                     .cast<int>()
                                     .cwiseMin(2 * count - Eigen::Vector3i::Ones());
    const Eigen::Vector3i at = fine / 2, within = fine - 2 * at;
    const std::size_t cell = std::size_t(at[0] + count[0] * (at[1] + Eigen::Index(count[1]) * at[2]));
    return 8 * cell + std::size_t(within[0] + 2 * within[1] + 4 * within[2]);
  };
  std::vector<Index> begin(8 * std::size_t(count.prod()) + 1, 0);
  for (Index t = 0; t < topology.tet_count(); ++t) ++begin[cell_of(t) + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  for (std::size_t i = 0; i + 1 < begin.size(); i += 8) {
    const Index first = static_cast<Index>(leaves_.size());
    for (std::size_t j = i; j < i + 8; ++j)
      if (begin[j] < begin[j + 1]) leaves_.push_back({begin[j], begin[j + 1], -1, {}, {}});
    if (const Index end = static_cast<Index>(leaves_.size()); first < end)
      groups_.push_back({first, end, -1, {}});
  }
  const auto tets = std::size_t(topology.tet_count());
  order_.resize(tets);
  boxes_.resize(tets);
  for (Index t = 0; t < topology.tet_count(); ++t) order_[begin[cell_of(t)]++] = t;
  leaf_of_.reserve(tets + tets / 4);
  leaf_of_.resize(tets);
  for (std::size_t i = 0; i < leaves_.size(); ++i)
    for (Index at = leaves_[i].begin; at < leaves_[i].end; ++at) leaf_of_[order_[at]] = static_cast<Index>(i);
}

// It is where the other is, and has the same box.
void TetGroups::add_copy(Index tet, Index copy) {
  if (leaves_.empty()) return;
  leaf_of_.resize(std::size_t(copy) + 1);
  leaf_of_[copy] = leaf_of_[tet];
  Leaf& leaf = leaves_[leaf_of_[tet]];
  const auto place_in = [tet](auto begin, auto end) {
    return std::size_t(std::find(begin, end, tet) - begin);
  };
  const std::size_t place = place_in(order_.begin() + leaf.begin, order_.begin() + leaf.end);
  const bool is_copy = place == std::size_t(leaf.end - leaf.begin);
  leaf.boxes_of_copies.push_back(is_copy
                                     ? leaf.boxes_of_copies[place_in(leaf.copies.begin(), leaf.copies.end())]
                                     : boxes_[std::size_t(leaf.begin) + place]);
  leaf.copies.push_back(copy);
}

Eigen::AlignedBox3d TetGroups::as_double(const TetBox& box) {
  const auto& s = box.sides;
  return {Vec3d(s[0], s[1], s[2]), Vec3d(-s[4], -s[5], -s[6])};
}

TetGroups::TetBox TetGroups::rounded(const Eigen::AlignedBox3d& box) {
  TetBox result{};
  for (std::size_t d = 0; d < 3; ++d) {
    result.sides[d] = static_cast<float>(box.min()[Eigen::Index(d)]);
    result.sides[4 + d] = -static_cast<float>(box.max()[Eigen::Index(d)]);
  }
  return result;
}

void TetGroups::forget_boxes(double reach) {
  for (Leaf& leaf : leaves_) leaf.path = -1;
  for (Group& group : groups_) group.path = -1;
  path_ = 0;
  reach_ = reach;
  is_lost_ = false;
}

template <class Box>
bool TetGroups::may_meet(const Box& group, const SweptVolume& volume) const {
  if (group.path < 0) return true;
  const double moved = path_ - group.path;
  if (group.box.isEmpty() || group.box.squaredExteriorDistance(volume.box) > moved * moved) return false;
  return !volume.may_meet || volume.may_meet(widened(group.box, moved));
}

template <class Real>
Mat34<double> TetGroups::Body<Real>::corners(Index tet) const {
  Mat34<double> x;
  for (int c = 0; c < 4; ++c) {
    const Index v = topology.tets()(c, tet);
    x.col(c) = points.col(v) + u.col(v).template cast<double>();
  }
  return x;
}

template <class Real>
void TetGroups::find_boxes(const Body<Real>& body, Leaf& leaf) {
  leaf.path = path_;
  leaf.box.setEmpty();
  const auto find = [&](Index t, TetBox& box) {
    if (!body.topology.alive(t)) return;
    const Eigen::AlignedBox3d now = box_around(body.corners(t));
    leaf.box.extend(now);
    box = rounded(now);
  };
  for (Index at = leaf.begin; at < leaf.end; ++at) find(order_[at], boxes_[std::size_t(at)]);
  for (std::size_t i = 0; i < leaf.copies.size(); ++i) find(leaf.copies[i], leaf.boxes_of_copies[i]);
}

// Corners are only looked at where a box may meet the volume.
template <class Real>
void TetGroups::search(const Body<Real>& body, const Leaf& leaf, const SweptVolume& volume,
                       std::vector<Index>& meeting) const {
  if (leaf.box.isEmpty()) return;
  const double farthest = leaf.box.min().cwiseAbs().cwiseMax(leaf.box.max().cwiseAbs()).maxCoeff();
  const double around = path_ - leaf.path + single_bits * farthest;
  const Eigen::AlignedBox3d within = widened(leaf.box, around).intersection(widened(volume.box, around));
  const TetBox near = rounded(widened(within, single_bits * farthest));
  std::array<float, 8> most;
  for (std::size_t i = 0; i < 8; ++i) most[i] = -near.sides[(i + 4) % 8];
  const auto look_at = [&](Index t, const TetBox& box) {
    int sides_within = 0;
    for (std::size_t i = 0; i < 8; ++i) sides_within += int(box.sides[i] <= most[i]);
    if (sides_within < 8 || !body.topology.alive(t)) return;
    if (volume.may_meet && !volume.may_meet(widened(as_double(box), around))) return;
    const Mat34<double> x = body.corners(t);
    if (box_around(x).intersects(volume.box) && (!volume.meets || volume.meets(x))) meeting.push_back(t);
  };
  for (Index at = leaf.begin; at < leaf.end; ++at) look_at(order_[at], boxes_[std::size_t(at)]);
  for (std::size_t i = 0; i < leaf.copies.size(); ++i) look_at(leaf.copies[i], leaf.boxes_of_copies[i]);
}

template <class Real>
std::vector<Index> TetGroups::meeting(const Topology& topology, const Mat3X<double>& points,
                                      const Mat3X<Real>& u, const SweptVolume& volume) {
  if (leaf_of_.size() != std::size_t(topology.tet_count())) {
    form(topology, points);
    is_lost_ = true;
  }
  if (is_lost_) forget_boxes(double(u.leftCols(topology.vertex_count()).colwise().norm().maxCoeff()));
  const Body<Real> body{topology, points, u};
  const auto is_wide = [&](const auto& box, double most) {
    return box.path < 0 || path_ - box.path > most * box.box.diagonal().norm();
  };
  std::vector<Index> meeting;
  for (Group& group : groups_) {
    if (!may_meet(group, volume)) continue;
    const bool is_group_wide = is_wide(group, much);
    if (is_group_wide) {
      group.path = path_;
      group.box.setEmpty();
    }
    for (Index i = group.begin; i < group.end; ++i) {
      Leaf& leaf = leaves_[i];
      if (!is_group_wide && !may_meet(leaf, volume)) continue;
      if (is_group_wide || is_wide(leaf, much_of_leaf)) find_boxes(body, leaf);
      if (is_group_wide) group.box.extend(leaf.box);
      search(body, leaf, volume, meeting);
    }
  }
  sort_unique(meeting);
  return meeting;
}

template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<float>&,
                                               const SweptVolume&);
template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<double>&,
                                               const SweptVolume&);

}  // namespace lobe
