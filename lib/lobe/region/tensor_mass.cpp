#include "lobe/region/tensor_mass.h"

#include "lobe/fem/hooke.h"

namespace lobe {

template <class Real>
void TensorMassRegion<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  member_.resize(std::size_t(elements.topology.tet_count()), 0);
  while (rows_.vertex_count() < elements.topology.vertex_count()) rows_.add_vertex();
  const auto set_member = [&](Index t, bool is) {
    tet_count_ += int(is) - int(member_[t]);
    member_[t] = is;
  };
  for (Index t : edit.left) set_member(t, false);
  for (Index t : edit.entered) set_member(t, elements.region_of[t] == RegionModel::tensor_mass);
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
    const Elastic& elastic = elements.elastic_of(t);
    int own = 0;
    while (corners[own] != vertex) ++own;
    for (int c = 0; c < 4; ++c) {
      if (c == own) continue;
      const Mat3<double> block = s.volume * hooke_block<double>(s.gradients.col(own), s.gradients.col(c),
                                                                elastic.lambda, elastic.mu);
      const auto found =
          std::find_if(row.begin(), row.end(), [&](const Sum& sum) { return sum.vertex == corners[c]; });
      if (found == row.end())
        row.push_back({corners[c], block});
      else
        found->block += block;
    }
  }
  rows_.clear(vertex);
  for (const Sum& sum : row) rows_.append(vertex, {sum.vertex, sum.block.template cast<Real>()});
}

template <class Real>
Vec3<Real> TensorMassRegion<Real>::force(const Mat3X<Real>& u, Index vertex) const {
  const Vec3<Real> own = u.col(vertex);
  Vec3<Real> sum = Vec3<Real>::Zero();
  for (const Entry& entry : rows_[vertex]) sum -= entry.block * (u.col(entry.vertex) - own);
  return sum;
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
      const Mat3<double> B = entry.block.template cast<double>();
      K.col(v) -= Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    }
}

template class TensorMassRegion<float>;
template class TensorMassRegion<double>;

}  // namespace lobe
