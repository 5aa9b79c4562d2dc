#include "lobe/region/tensor_mass.h"

#include <algorithm>

#include "lobe/fem/fibre_term.h"
#include "lobe/fem/hooke.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

bool has_blocks(const Elements& elements, Index tet) {
  return elements.region_of[tet] == RegionModel::tensor_mass && !elements.elastic_of(tet).is_smoothed();
}

int corner_of(const Eigen::Vector4i& corners, Index vertex) {
  for (int c = 0; c < 4; ++c)
    if (corners[c] == vertex) return c;
  return -1;
}

// Computes V B_ij of linear_block() from the area vectors of the faces opposite to two corners. α_c (shape.h)
// is minus the area vector of its face, divided by 3V.
Mat3<double> block_of(const Elements& elements, Index tet, int corner, int other) {  // [N/m]
  const Mat34<double> X = elements.corner_points(tet);
  const auto doubled_area = [&](int c) -> Vec3d {
    const int* face = face_corners[c];
    return (X.col(face[1]) - X.col(face[0])).cross(X.col(face[2]) - X.col(face[0]));
  };
  const Vec3d a = doubled_area(corner), b = doubled_area(other);
  const double per_36_volumes =
      elements.share_of(tet) / (6 * a.dot(X.col(face_corners[corner][0]) - X.col(corner)));
  const Elastic& elastic = elements.elastic_of(tet);  // without a Law: a cut sums six edges' blocks again
  const Mat3<double> block =
      hooke_block<double>(a, b, per_36_volumes * elastic.lambda, per_36_volumes * elastic.mu);
  if (!elastic.fibre.any()) return block;
  return block + fibre_block<double>(a, b, elastic.fibre.times(per_36_volumes), elements.fibre_of(tet));
}

// Sums K_ij over the region's plain tetrahedra that are alive. Returns whether there are any.
bool sum_block(const Elements& elements, Index i, Index j, Mat3<double>& sum) {
  sum.setZero();
  bool any = false;
  const auto& tets = elements.topology.tets();
  const std::span<const Index> around_i = elements.topology.around(i), around_j = elements.topology.around(j);
  const bool from_i = around_i.size() <= around_j.size();  // the shorter list
  for (Index t : from_i ? around_i : around_j) {
    if ((tets.col(t).array() != (from_i ? j : i)).all()) continue;
    if (!has_blocks(elements, t)) continue;
    const Eigen::Vector4i corners = tets.col(t);
    sum += block_of(elements, t, corner_of(corners, i), corner_of(corners, j));
    any = true;
  }
  return any;
}

}  // namespace

template <class Real>
void TensorMassRegion<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  struct Fresh {
    Index edge;
    Mat3<Real> block;
  };
  smoothed_.follow(elements, edit.left, edit.entered, RegionModel::tensor_mass);
  const auto enters = [&](Index t) { return has_blocks(elements, t); };
  if (tet_count_ == 0 && std::none_of(edit.entered.begin(), edit.entered.end(), enters))
    return;  // without tetrahedra no memory is needed
  const std::vector<Index> removed = update_members(elements, edit);
  while (neighbours_.vertex_count() < elements.topology.vertex_count()) neighbours_.add_vertex();
  std::vector<Fresh> fresh;
  std::vector<Layout::Item> entered;
  for (const Ends& ends : touched_edges(elements, edit, removed)) {
    Index edge = edge_of(ends);
    Mat3<double> block;
    if (sum_block(elements, ends[0], ends[1], block)) {
      if (edge < 0) entered.push_back({edge = add_edge(ends), ends});
      fresh.push_back({edge, block.cast<Real>()});
    } else if (edge >= 0) {
      erase_edge(ends, edge);
    }
  }
  layout_.resize(elements.topology.vertex_count(), edge_numbers_);
  layout_.enter(entered, elements.points.padded());
  resize_with_room(blocks_, std::size_t(layout_.patch_count()) * patch_blocks);
  sums_.resize(layout_.patch_count());
  for (const Layout::Item& item : entered) write_ends(item);
  for (const Fresh& f : fresh) write(f.edge, f.block);
}

// Returns the tetrahedra that are no members any more, or have other corners.
template <class Real>
std::vector<Index> TensorMassRegion<Real>::update_members(const Elements& elements, const RegionEdit& edit) {
  member_.resize(std::size_t(elements.topology.tet_count()), 0);
  std::vector<Index> removed;
  for (Index t : edit.left) {
    if (member_[t]) removed.push_back(t);
    tet_count_ -= member_[t];
    member_[t] = 0;
  }
  for (Index t : edit.entered) {
    member_[t] = has_blocks(elements, t);
    tet_count_ += member_[t];
  }
  return removed;
}

// Finds the edges of the tetrahedra that left or entered. If corners may have changed, it also finds all
// edges between the vertices of the edit.
template <class Real>
std::vector<typename TensorMassRegion<Real>::Ends> TensorMassRegion<Real>::touched_edges(
    const Elements& elements, const RegionEdit& edit, const std::vector<Index>& removed) const {
  std::vector<std::uint64_t> keys;  // both ends in one number, which is faster to sort
  const auto add = [&](Index low, Index high) {
    keys.push_back(std::uint64_t(low) << 32 | std::uint64_t(high));
  };
  const auto add_edges_of = [&](Index t) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (const auto& edge : edge_corners) {
      const auto [low, high] = std::minmax(corners[edge[0]], corners[edge[1]]);
      add(low, high);
    }
  };
  for (Index t : removed) add_edges_of(t);
  for (Index t : edit.entered)
    if (member_[t]) add_edges_of(t);
  if (!edit.entered.empty()) {
    std::vector<bool> is_of_edit(std::size_t(elements.topology.vertex_count()), false);
    for (Index v : edit.vertices) is_of_edit[std::size_t(v)] = true;
    for (Index v : edit.vertices)
      for (const Neighbour& n : neighbours_[v])
        if (is_of_edit[std::size_t(n.vertex)]) add(v, n.vertex);
  }
  if (keys.size() != 6) sort_unique(keys);  // they are of one tetrahedron else
  std::vector<Ends> edges;
  edges.reserve(keys.size());
  for (std::uint64_t key : keys)
    edges.push_back({static_cast<Index>(key >> 32), static_cast<Index>(key & 0xFFFFFFFFU)});
  return edges;
}

template <class Real>
Index TensorMassRegion<Real>::edge_of(const Ends& ends) const {
  for (const Neighbour& n : neighbours_[ends[0]])
    if (n.vertex == ends[1]) return n.edge;
  return -1;
}

template <class Real>
Index TensorMassRegion<Real>::add_edge(const Ends& ends) {
  if (unused_.empty()) unused_.push_back(edge_numbers_++);
  const Index edge = unused_.back();
  unused_.pop_back();
  neighbours_.append(ends[0], {ends[1], edge});
  return edge;
}

template <class Real>
void TensorMassRegion<Real>::erase_edge(const Ends& ends, Index edge) {
  const std::span<const Neighbour> list = neighbours_[ends[0]];
  neighbours_.erase(
      ends[0], &*std::find_if(list.begin(), list.end(), [&](const Neighbour& n) { return n.edge == edge; }));
  unused_.push_back(edge);
  const Index slot = layout_.slot_of(edge);
  const auto& corners = blocks_[slot / width].corners;
  const Index last = layout_.leave(edge, {corners[0][slot % width], corners[1][slot % width]});
  const auto move = [&](auto& from, auto& to) {  // and leave zeros
    for (std::size_t i = 0; i < from.size(); ++i) {
      to[i][slot % width] = from[i][last % width];
      from[i][last % width] = 0;
    }
  };
  move(blocks_[last / width].K, blocks_[slot / width].K);
  move(blocks_[last / width].corners, blocks_[slot / width].corners);
}

template <class Real>
void TensorMassRegion<Real>::write_ends(const Layout::Item& item) {
  const Index slot = layout_.slot_of(item.id);
  const auto local = layout_.local_corners(slot / Layout::capacity, item.corners);
  for (int c = 0; c < 2; ++c) blocks_[slot / width].corners[c][slot % width] = local[c];
}

template <class Real>
void TensorMassRegion<Real>::write(Index edge, const Mat3<Real>& block) {
  const Index slot = layout_.slot_of(edge);
  for (int i = 0; i < 9; ++i) blocks_[slot / width].K[i][slot % width] = block.data()[i];
}

template <class Real>
void TensorMassRegion<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  smoothed_.add_forces(u, f, parallel);
  if (tet_count_ == 0) return;
  sums_.add_forces(layout_, u, f, parallel, [&](Index p, const auto& local, PaddedVector<Real>* sums) {
    kernels_.add_edge_forces(blocks_.data() + std::size_t(p) * patch_blocks,
                             (layout_.patch(p).items + width - 1) / width, local.data(), sums);
  });
}

// Calls visit(i, j, K_ij).
template <class Real>
template <class Visit>
void TensorMassRegion<Real>::for_edges(Visit&& visit) const {
  for (Index p = 0; p < layout_.patch_count(); ++p)
    for (Index slot = p * Layout::capacity; slot < p * Layout::capacity + layout_.patch(p).items; ++slot) {
      const Block& block = blocks_[slot / width];
      const int lane = slot % width;
      Mat3<double> K;
      for (int i = 0; i < 9; ++i) K.data()[i] = double(block.K[i][lane]);
      visit(layout_.vertices(p)[block.corners[0][lane]], layout_.vertices(p)[block.corners[1][lane]], K);
    }
}

template <class Real>
double TensorMassRegion<Real>::energy(const Mat3X<Real>& u) {
  double sum = smoothed_.energy(u);
  for_edges(
      [&](Index i, Index j, const Mat3<double>& K) {  // minus half of each end's displacement times its force
        const Vec3d u_i = u.col(i).template cast<double>(), other = u.col(j).template cast<double>();
        sum += 0.5 * (u_i.dot(K * (other - u_i)) - other.dot(K.transpose() * (other - u_i)));
      });
  return sum;
}

template <class Real>
SmallestVolumeRatio TensorMassRegion<Real>::add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K,
                                                                   Parallel& parallel) {
  smoothed_.add_diagonal_stiffness(u, K, parallel);
  for_edges([&](Index i, Index j, const Mat3<double>& B) {
    K.col(i) -= Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    K.col(j) -= Eigen::Matrix<double, 6, 1>(B(0, 0), B(1, 0), B(2, 0), B(1, 1), B(2, 1), B(2, 2));
  });
  return {};
}

template class TensorMassRegion<float>;
template class TensorMassRegion<double>;

}  // namespace lobe
