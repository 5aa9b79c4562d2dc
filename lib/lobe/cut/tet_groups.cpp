#include "lobe/cut/tet_groups.h"

#include <algorithm>
#include <cmath>

namespace lobe {
namespace {

constexpr double group_size = 200;  // tetrahedra on average

}  // namespace

// Cells of a grid over the body at rest; a tetrahedron belongs to the cell of its first vertex.
void TetGroups::form(const Topology& topology, const Mat3X<double>& points) {
  group_of_.clear();
  Eigen::AlignedBox3d body;
  for (Index v = 0; v < topology.vertex_count(); ++v) body.extend(points.col(v));
  const double cells = std::max(1.0, topology.alive_count() / group_size);
  const Vec3d size = body.sizes().cwiseMax(1e-3 * body.sizes().maxCoeff());
  const double edge = std::cbrt(size.prod() / cells);
  const Eigen::Vector3i count = (size / edge).array().ceil().cast<int>().cwiseMax(1);
  const auto cell_of = [&](Index t) {
    const Eigen::Vector3i at = ((points.col(topology.tets()(0, t)) - body.min()) / edge)
                                   .cast<int>()
                                   .cwiseMin(count - Eigen::Vector3i::Ones());
    return std::size_t(at[0] + count[0] * (at[1] + Eigen::Index(count[1]) * at[2]));
  };
  std::vector<Index> begin(std::size_t(count.prod()) + 1, 0);
  for (Index t = 0; t < topology.tet_count(); ++t) ++begin[cell_of(t) + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
    if (begin[i] < begin[i + 1]) groups_.push_back({begin[i], begin[i + 1], -1, {}, {}});
  order_.resize(std::size_t(topology.tet_count()));
  for (Index t = 0; t < topology.tet_count(); ++t) order_[begin[cell_of(t)]++] = t;
}

void TetGroups::add_copy(Index tet, Index copy) {
  if (groups_.empty()) return;
  if (group_of_.empty()) {
    group_of_.resize(order_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (Index i = groups_[g].begin; i < groups_[g].end; ++i) group_of_[order_[i]] = static_cast<Index>(g);
  }
  group_of_.resize(std::size_t(copy) + 1);
  group_of_[copy] = group_of_[tet];
  groups_[group_of_[tet]].copies.push_back(copy);
  groups_[group_of_[tet]].path = -1;
}

template <class Real>
std::vector<Index> TetGroups::meeting(const Topology& topology, const Mat3X<double>& points,
                                      const Mat3X<Real>& u, const SweptVolume& volume) {
  if (groups_.empty()) {
    form(topology, points);
    path_ = 0;
    reach_ = double(u.leftCols(topology.vertex_count()).colwise().norm().maxCoeff());
  }
  const auto corners_of = [&](Index t) -> Mat34<double> {
    const Eigen::Vector4i v = topology.corners(t);
    return points(Eigen::all, v) + u(Eigen::all, v).template cast<double>();
  };
  std::vector<Index> meeting;
  for (Group& group : groups_) {
    const double moved = path_ - group.path;
    if (group.path >= 0 &&
        (group.box.isEmpty() || group.box.squaredExteriorDistance(volume.box) > moved * moved))
      continue;
    group.path = path_;
    group.box.setEmpty();
    const auto look_at = [&](Index t) {
      if (!topology.alive(t)) return;
      const Mat34<double> x = corners_of(t);
      const Eigen::AlignedBox3d box(x.rowwise().minCoeff(), x.rowwise().maxCoeff());
      group.box.extend(box);
      if (box.intersects(volume.box) && (!volume.meets || volume.meets(x))) meeting.push_back(t);
    };
    for (Index i = group.begin; i < group.end; ++i) look_at(order_[i]);
    for (Index t : group.copies) look_at(t);
  }
  std::sort(meeting.begin(), meeting.end());
  return meeting;
}

template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<float>&,
                                               const SweptVolume&);
template std::vector<Index> TetGroups::meeting(const Topology&, const Mat3X<double>&, const Mat3X<double>&,
                                               const SweptVolume&);

}  // namespace lobe
