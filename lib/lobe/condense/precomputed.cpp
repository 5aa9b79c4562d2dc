#include "lobe/condense/precomputed.h"

#include <algorithm>
#include <cmath>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

template <class Real, class Vertices>
Mat3X<double> displacements_of(const Mat3X<Real>& u, const Vertices& vertices) {
  return u(Eigen::all, vertices).template cast<double>();
}

}  // namespace

template <class Real>
void PrecomputedRegion<Real>::add_forces(const Mat3X<Real>& u, Real missing_share, Mat3X<Real>& f,
                                         Parallel& parallel) {
  if (is_expanded_) return;
  if (has_frame_) return add_forces_in_frame(u, missing_share, f, parallel);
  add_stiffness_forces(u, f, parallel);
  for (Index i = 0; i < interface_size(); ++i)
    f.data()[components_[i]] += static_cast<Real>(of_loads_(i, 0) + double(missing_share) * of_loads_(i, 1));
}

template <class Real>
void PrecomputedRegion<Real>::add_stiffness_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  if (is_expanded_) return;
  const Index n = interface_size();
  for (Index i = 0; i < n; ++i) stiffness_.x()[i] = u.data()[components_[i]];
  const std::vector<Real>& product = stiffness_.multiply(parallel);
  for (Index i = 0; i < n; ++i) f.data()[components_[i]] -= product[i];
}

template <class Real>
void PrecomputedRegion<Real>::add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K) const {
  if (is_expanded_) return;
  Pose pose;
  if (has_frame_) place(u, pose);
  for (Index v : has_frame_ ? vertices_ : shared_) {
    Mat3<double> S = Mat3<double>::Zero();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Index row = condensed_->column(3 * v + i), column = condensed_->column(3 * v + j);
        if (row < 0 || column < 0) continue;  // fixed
        S(i, j) = condensed_->stiffness()(amplitudes() + row, amplitudes() + column);
      }
    S = pose.R * S * pose.R.transpose();
    K.col(v) += Eigen::Matrix<double, 6, 1>(S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2));
  }
}

template <class Real>
void PrecomputedRegion<Real>::find_carried(const Elements& elements) {
  if (is_expanded_) return;
  carried_.assign(std::size_t(roles_.cols()), 0);
  if (tet_count_ == 0) return;
  const Eigen::VectorXd& follows =
      condensed_->inertia(interior_masses(elements, roles_), shared_components(elements, roles_));
  double all = 0, positive = 0;  // the few that are not go to the others
  for (Index v : shared_) {
    double share = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (const Index at = condensed_->column(3 * v + axis); at >= 0) share += follows[at] / 3;
    carried_[v] = std::max(0.0, share);
    all += share;
    positive += carried_[v];
  }
  for (Index v : shared_) {
    carried_[v] = positive > 0 ? std::max(0.0, all) / positive * carried_[v] : 0;
  }
}

template <class Real>
std::vector<Index> PrecomputedRegion<Real>::take_over(const Elements& elements,
                                                      const std::vector<Index>& vertices,
                                                      std::vector<double>& mass, Mat3X<Real>& external,
                                                      Mat3X<Real>& dead) const {
  std::vector<Index> taken;
  if (tet_count_ == 0 || is_expanded_) return taken;
  for (Index v : vertices) {
    const bool is_inside = is_interior(v);
    if (!is_inside && !std::binary_search(shared_.begin(), shared_.end(), v)) continue;
    mass[v] = is_inside ? 0 : lumped_mass(elements, v) + carried(v);
    for (int axis = 0; axis < 3; ++axis)
      if (roles_(axis, v) == Role::interior) external(axis, v) = dead(axis, v) = 0;
    taken.push_back(v);
  }
  return taken;
}

template <class Real>
double PrecomputedRegion<Real>::inertia_error(const Vec3d& acceleration) const {
  return tet_count_ > 0 ? condensed_->unit_inertia_error().cwiseProduct(acceleration).norm() : 0;
}

template <class Real>
void PrecomputedRegion<Real>::recover(const Elements& elements, Real missing_share, Mat3X<Real>& u,
                                      Mat3X<Real>* v) const {
  if (tet_count_ == 0 || is_expanded_) return;
  if (has_frame_) return recover_in_frame(elements, missing_share, u, v);
  const Index n = interface_size();
  Eigen::MatrixXd driven = Eigen::MatrixXd::Zero(2 + n, v ? 2 : 1);
  driven.topLeftCorner<2, 1>() << 1, double(missing_share);
  for (Index i = 0; i < n; ++i) {
    driven(2 + i, 0) = double(u.data()[components_[i]]);
    if (v) driven(2 + i, 1) = double(v->data()[components_[i]]);
  }
  const Eigen::MatrixXd field = condensed_->field(driven);
  for (Eigen::Index i = 0; i < roles_.size(); ++i) {
    if (roles_.data()[i] != Role::interior) continue;
    u.data()[i] = static_cast<Real>(field(i, 0));
    if (v) v->data()[i] = static_cast<Real>(field(i, 1));
  }
}

template <class Real>
typename PrecomputedRegion<Real>::Energy PrecomputedRegion<Real>::energy(const Elements& elements,
                                                                         const Mat3X<Real>& u) const {
  Energy e;
  if (tet_count_ == 0 || is_expanded_) return e;
  Pose pose;
  if (has_frame_) place(u, pose);
  const auto in_frame = [&](const auto& vertices) -> Mat3X<double> {
    const Mat3X<double> X = elements.points.view()(Eigen::all, vertices);
    return pose.R.transpose() * (X + displacements_of(u, vertices)) - X;
  };
  for (Index t = 0; t < static_cast<Index>(member_.size()); ++t)
    if (member_[t] && linearisation_.is_element(elements, t))
      e.elastic += linearisation_.energy(elements, t, in_frame(elements.topology.corners(t)));
  for (Index i = 0; i < domains_.count(); ++i)
    if (domains_[i].volume > 0)
      e.elastic += linearisation_.energy(elements, domains_[i], in_frame(domains_[i].vertices));
  e.loads = -loads_[0].cwiseProduct(u.leftCols(loads_[0].cols()).template cast<double>()).sum();
  return e;
}

template <class Real>
Vec3d PrecomputedRegion<Real>::force_on_fixed(const Elements& elements, const Mat3X<Real>& u,
                                              Index vertex) const {
  Vec3d force = Vec3d::Zero();
  if (is_expanded_) return force;
  const auto add = [&](const auto& element, const auto& vertices) {
    const Mat3X<double> f = linearisation_.forces_at(elements, element, displacements_of(u, vertices));
    const auto at = std::find(vertices.begin(), vertices.end(), vertex);
    force += f.col(at - vertices.begin());
  };
  std::vector<Index> domains;
  for (Index t : elements.topology.around(vertex)) {
    if (!has(t)) continue;
    if (linearisation_.is_element(elements, t)) add(t, elements.topology.corners(t));
    for (Index e : domains_.of(t))
      if (e >= 0) domains.push_back(e);
  }
  sort_unique(domains);
  for (Index e : domains) add(domains_[e], domains_[e].vertices);
  for (int axis = 0; axis < 3; ++axis)
    if (tet_count_ > 0 && roles_(axis, vertex) != Role::none) force[axis] = 0;
  return force;
}

template class PrecomputedRegion<float>;
template class PrecomputedRegion<double>;

}  // namespace lobe
