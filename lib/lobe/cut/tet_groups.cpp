#include "lobe/cut/tet_groups.h"

#include <algorithm>
#include <cmath>

namespace lobe {
namespace {

constexpr double group_size = 200;  // tetrahedra on average; an eighth of it in each leaf

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
  order_.resize(std::size_t(topology.tet_count()));
  for (Index t = 0; t < topology.tet_count(); ++t) order_[begin[cell_of(t)]++] = t;
}

void TetGroups::add_copy(Index tet, Index copy) {
  if (leaves_.empty()) return;
  if (leaf_of_.empty()) {
    leaf_of_.resize(order_.size());
    for (std::size_t g = 0; g < leaves_.size(); ++g)
      for (Index i = leaves_[g].begin; i < leaves_[g].end; ++i) leaf_of_[order_[i]] = static_cast<Index>(g);
  }
  leaf_of_.resize(std::size_t(copy) + 1);
  leaf_of_[copy] = leaf_of_[tet];
  leaves_[leaf_of_[tet]].copies.push_back(copy);
}

template <class Box>
bool TetGroups::may_meet(const Box& group, const SweptVolume& volume) const {
  if (group.path < 0) return true;
  const double moved = path_ - group.path;
  if (group.box.isEmpty() || group.box.squaredExteriorDistance(volume.box) > moved * moved) return false;
  const Vec3d around = Vec3d::Constant(moved);
  return !volume.may_meet || volume.may_meet({group.box.min() - around, group.box.max() + around});
}

template <class Real>
std::vector<Index> TetGroups::meeting(const Topology& topology, const Mat3X<double>& points,
                                      const Mat3X<Real>& u, const SweptVolume& volume) {
  const std::size_t known = leaf_of_.empty() ? order_.size() : leaf_of_.size();
  if (known != std::size_t(topology.tet_count())) {
    form(topology, points);
    is_lost_ = true;
  }
  if (is_lost_) {
    for (Leaf& leaf : leaves_) leaf.path = -1;
    for (Group& group : groups_) group.path = -1;
    path_ = 0;
    reach_ = double(u.leftCols(topology.vertex_count()).colwise().norm().maxCoeff());
    is_lost_ = false;
  }
  std::vector<Index> meeting;
  const auto look_at = [&](Index t, Eigen::AlignedBox3d& around) {
    if (!topology.alive(t)) return;
    Mat34<double> x;
    for (int c = 0; c < 4; ++c) {
      const Index v = topology.tets()(c, t);
      x.col(c) = points.col(v) + u.col(v).template cast<double>();
    }
    const Eigen::AlignedBox3d box(x.rowwise().minCoeff(), x.rowwise().maxCoeff());
    around.extend(box);
    if (box.intersects(volume.box) && (!volume.meets || volume.meets(x))) meeting.push_back(t);
  };
  for (Group& group : groups_) {
    if (!may_meet(group, volume)) continue;
    constexpr double much = 0.1;  // of its size, by which a box is wider than it need be
    const bool is_wide = group.path < 0 || path_ - group.path > much * group.box.diagonal().norm();
    if (is_wide) {
      group.path = path_;
      group.box.setEmpty();
    }
    for (Index i = group.begin; i < group.end; ++i) {
      Leaf& leaf = leaves_[i];
      if (!is_wide && !may_meet(leaf, volume)) continue;
      leaf.path = path_;
      leaf.box.setEmpty();
      for (Index at = leaf.begin; at < leaf.end; ++at) look_at(order_[at], leaf.box);
      for (Index t : leaf.copies) look_at(t, leaf.box);
      if (is_wide) group.box.extend(leaf.box);
    }
  }
  std::sort(meeting.begin(), meeting.end());
  return meeting;
}

template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<float>&,
                                               const SweptVolume&);
template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<double>&,
                                               const SweptVolume&);

}  // namespace lobe
