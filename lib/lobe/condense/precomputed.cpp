#include "lobe/condense/precomputed.h"

#include "lobe/fem/hooke.h"

namespace lobe {
namespace {

template <class Real>
Mat3<double> gradient_of(const Elements& elements, const Mat3X<Real>& u, Index tet, const Shape& shape) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c)
    corners.col(c) = u.col(elements.topology.tets()(c, tet)).template cast<double>();
  return displacement_gradient<double>(corners, shape.gradients.rightCols<3>());
}

}  // namespace

template <class Real>
void PrecomputedRegion<Real>::add_forces(const Mat3X<Real>& u, Real missing, Mat3X<Real>& f,
                                         Parallel& parallel) {
  if (has_frame_) return add_forces_in_frame(u, missing, f, parallel);
  add_stiffness_forces(u, f, parallel);
  for (Index i = 0; i < interface_size(); ++i)
    f.data()[components_[i]] += static_cast<Real>(of_loads_(i, 0) + double(missing) * of_loads_(i, 1));
}

template <class Real>
void PrecomputedRegion<Real>::add_stiffness_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  const Index n = interface_size();
  for (Index i = 0; i < n; ++i) stiffness_.x()[i] = u.data()[components_[i]];
  const std::vector<Real>& own = stiffness_.multiply(parallel);
  for (Index i = 0; i < n; ++i) f.data()[components_[i]] -= own[i];
}

template <class Real>
void PrecomputedRegion<Real>::add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K) const {
  Pose pose;
  if (has_frame_) place(u, pose);
  for (Index v : has_frame_ ? vertices_ : shared_) {
    Mat3<double> S = Mat3<double>::Zero();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Index row = reduced_->column(3 * v + i), column = reduced_->column(3 * v + j);
        if (row < 0 || column < 0) continue;  // fixed
        S(i, j) = reduced_->stiffness()(amplitudes() + row, amplitudes() + column);
      }
    S = pose.R * S * pose.R.transpose();
    K.col(v) += Eigen::Matrix<double, 6, 1>(S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2));
  }
}

template <class Real>
const std::vector<Index>& PrecomputedRegion<Real>::move_mass(const Elements& elements,
                                                             std::vector<double>& mass) const {
  if (tet_count_ == 0) return shared_;
  std::vector<double> own(shared_.size(), 0);
  double of_shared = 0, of_region = 0;
  const auto share = [&](Index t) {
    return elements.elastic_of(t).density * signed_volume(elements.corner_points(t)) / 4;
  };
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    for (Index t : elements.topology.around(shared_[i]))
      if (member_[t]) own[i] += share(t);
    of_shared += own[i];
  }
  for (Index t = 0; t < static_cast<Index>(member_.size()); ++t) {
    if (!member_[t]) continue;
    for (Index v : elements.topology.corners(t)) {
      if (!is_interior(v)) continue;
      of_region += share(t);
      mass[v] = 0;
    }
  }
  for (std::size_t i = 0; i < shared_.size(); ++i)
    mass[shared_[i]] = lumped_mass(elements, shared_[i]) + of_region * own[i] / of_shared;
  return shared_;
}

template <class Real>
void PrecomputedRegion<Real>::recover(const Elements& elements, Real missing, Mat3X<Real>& u,
                                      Mat3X<Real>& v) const {
  if (tet_count_ == 0) return;
  if (has_frame_) return recover_in_frame(elements, missing, u, v);
  const Index n = interface_size();
  Eigen::MatrixXd driven(2 + n, 2);
  driven.topRows<2>() << 1, 0, double(missing), 0;
  for (Index i = 0; i < n; ++i)
    driven.row(2 + i) << double(u.data()[components_[i]]), double(v.data()[components_[i]]);
  const Eigen::MatrixXd field = reduced_->field(driven);
  for (Eigen::Index i = 0; i < roles_.size(); ++i) {
    if (roles_.data()[i] != Role::interior) continue;
    u.data()[i] = static_cast<Real>(field(i, 0));
    v.data()[i] = static_cast<Real>(field(i, 1));
  }
}

template <class Real>
typename PrecomputedRegion<Real>::Energy PrecomputedRegion<Real>::energy(const Elements& elements,
                                                                         const Mat3X<Real>& u) const {
  Energy e;
  if (tet_count_ == 0) return e;
  Pose pose;
  if (has_frame_) place(u, pose);
  const Mat3<double> I = Mat3<double>::Identity();
  for (Index t = 0; t < static_cast<Index>(member_.size()); ++t) {
    if (!member_[t]) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& elastic = elements.elastic_of(t);
    const Mat3<double> H = pose.R.transpose() * (I + gradient_of(elements, u, t, s)) - I;
    e.elastic += s.volume * hooke_energy_density(H, elastic.lambda, elastic.mu);
  }
  e.loads = -loads_[0].cwiseProduct(u.leftCols(loads_[0].cols()).template cast<double>()).sum();
  return e;
}

template <class Real>
Vec3d PrecomputedRegion<Real>::force_on_fixed(const Elements& elements, const Mat3X<Real>& u,
                                              Index vertex) const {
  Vec3d force = Vec3d::Zero();
  for (Index t : elements.topology.around(vertex)) {
    if (!has(t)) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& elastic = elements.elastic_of(t);
    const Mat3<double> stress = hooke_stress(gradient_of(elements, u, t, s), elastic.lambda, elastic.mu);
    for (int c = 0; c < 4; ++c)
      if (elements.topology.tets()(c, t) == vertex) force -= s.volume * stress * s.gradients.col(c);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (tet_count_ > 0 && roles_(axis, vertex) != Role::none) force[axis] = 0;
  return force;
}

template class PrecomputedRegion<float>;
template class PrecomputedRegion<double>;

}  // namespace lobe
