#include "lobe/region/tensor_mass.h"

#include <cstring>

#include "lobe/fem/hooke.h"

namespace lobe {
namespace {

int corner_of(const Eigen::Vector4i& corners, Index vertex) {
  for (int c = 0; c < 4; ++c)
    if (corners[c] == vertex) return c;
  return -1;
}

Mat3<double> block_of(const Elements& elements, Index tet, const Shape& s, int own, int other) {  // [N/m]
  const Elastic& elastic = elements.elastic_of(tet);
  return s.volume *
         hooke_block<double>(s.gradients.col(own), s.gradients.col(other), elastic.lambda, elastic.mu);
}

template <class Real>
std::array<Real, 9> column_by_column(const Mat3<double>& block) {
  std::array<Real, 9> numbers;
  for (int i = 0; i < 9; ++i) numbers[i] = static_cast<Real>(block.data()[i]);
  return numbers;
}

}  // namespace

template <class Real>
void TensorMassRegion<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  member_.resize(std::size_t(elements.topology.tet_count()), 0);
  while (rows_.vertex_count() < elements.topology.vertex_count()) rows_.add_vertex();
  std::vector<Index> removed;
  for (Index t : edit.left) {
    if (member_[t]) removed.push_back(t);
    tet_count_ -= member_[t];
    member_[t] = 0;
  }
  for (Index t : edit.entered) {
    member_[t] = elements.region_of[t] == RegionModel::tensor_mass;
    tet_count_ += member_[t];
  }
  if (edit.entered.empty())
    refresh_edges(elements, removed);
  else
    for (Index v : edit.vertices) gather_row(elements, v);
}

template <class Real>
void TensorMassRegion<Real>::gather_row(const Elements& elements, Index vertex) {
  struct Sum {
    Index vertex;
    Mat3<double> block;
  };
  std::vector<Sum> row;
  for (Index t : elements.topology.around(vertex)) {
    if (elements.region_of[t] != RegionModel::tensor_mass) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const Shape s = elements.shape_of(t);
    const int own = corner_of(corners, vertex);
    for (int c = 0; c < 4; ++c) {
      if (c == own) continue;
      const Mat3<double> block = block_of(elements, t, s, own, c);
      const auto found =
          std::find_if(row.begin(), row.end(), [&](const Sum& sum) { return sum.vertex == corners[c]; });
      if (found == row.end())
        row.push_back({corners[c], block});
      else
        found->block += block;
    }
  }
  std::vector<Entry> entries;
  for (const Sum& sum : row) entries.push_back({column_by_column<Real>(sum.block), sum.vertex});
  rows_.assign(vertex, entries);
}

// Tetrahedra that are gone leave the blocks of their edges to those that are left around these.
template <class Real>
void TensorMassRegion<Real>::refresh_edges(const Elements& elements, const std::vector<Index>& removed) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index t : removed)
    for (const auto& edge : edge_corners)
      edges.push_back(
          std::minmax({elements.topology.tets()(edge[0], t), elements.topology.tets()(edge[1], t)}));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [i, j] : edges) {
    Mat3<double> sum = Mat3<double>::Zero();
    bool is_edge = false;
    for (Index t : elements.topology.around(i)) {
      const Eigen::Vector4i corners = elements.topology.corners(t);
      const int other = corner_of(corners, j);
      if (other < 0 || elements.region_of[t] != RegionModel::tensor_mass) continue;
      sum += block_of(elements, t, elements.shape_of(t), corner_of(corners, i), other);
      is_edge = true;
    }
    set_block(i, j, is_edge, sum);
    set_block(j, i, is_edge, sum.transpose());
  }
}

template <class Real>
void TensorMassRegion<Real>::set_block(Index vertex, Index other, bool is_edge, const Mat3<double>& block) {
  const std::span<Entry> row = rows_[vertex];
  Entry& entry = *std::find_if(row.begin(), row.end(), [&](const Entry& e) { return e.vertex == other; });
  if (is_edge)
    entry.block = column_by_column<Real>(block);
  else
    rows_.erase(vertex, &entry);
}

template <class Real>
Vec3<Real> TensorMassRegion<Real>::force(const Mat3X<Real>& u, Index vertex) const {
  // A column of a block in one register, with a fourth number that nobody reads.
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  const Real* own = &u(0, vertex);
  Four sum{}, first, second, last;
  for (const Entry& entry : rows_[vertex]) {
    const Real *other = &u(0, entry.vertex), *K = entry.block.data();
    std::memcpy(&first, K, sizeof(Four));
    std::memcpy(&second, K + 3, sizeof(Four));
    std::memcpy(&last, K + 5, sizeof(Four));  // K + 6 would reach beyond the block
    sum -= first * (other[0] - own[0]) + second * (other[1] - own[1]) +
           Four{last[1], last[2], last[3], last[0]} * (other[2] - own[2]);
  }
  return {sum[0], sum[1], sum[2]};
}

template <class Real>
void TensorMassRegion<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) const {
  if (tet_count_ == 0) return;
  parallel.for_ranges(rows_.vertex_count(), 512, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      if (!rows_[v].empty()) f.col(v) += force(u, v);
  });
}

template <class Real>
double TensorMassRegion<Real>::energy(const Mat3X<Real>& u) const {
  double sum = 0;
  for (Index v = 0; v < rows_.vertex_count(); ++v)
    if (!rows_[v].empty()) sum -= 0.5 * double(u.col(v).dot(force(u, v)));
  return sum;
}

template <class Real>
void TensorMassRegion<Real>::add_diagonal_stiffness(DiagonalStiffness& K) const {
  for (Index v = 0; v < rows_.vertex_count(); ++v)
    for (const Entry& entry : rows_[v]) {
      const Mat3<double> B = Eigen::Map<const Mat3<Real>>(entry.block.data()).template cast<double>();
      K.col(v) -= Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    }
}

template class TensorMassRegion<float>;
template class TensorMassRegion<double>;

}  // namespace lobe
