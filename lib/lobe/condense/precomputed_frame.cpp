// The pre-computed region in a frame that turns with it (theory, section 14).
#include "lobe/condense/precomputed.h"

namespace lobe {

template <class Real>
void PrecomputedRegion<Real>::prepare_frame(const Elements& elements) {
  const auto count = Eigen::Index(vertices_.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);  // volume of the region around each vertex
  for (Eigen::Index i = 0; i < count; ++i)
    for (Index t : elements.topology.around(vertices_[std::size_t(i)]))
      if (member_[t]) weights[i] += elements.volume(t) / 4;
  rest_ = elements.points.view()(Eigen::all, vertices_);
  frame_ = RigidFrame(rest_, std::move(weights));
  forces_.resize(3, count);
  at_rest_.setZero(amplitudes());
  has_loads_ = !loads_[0].isZero(0) || !loads_[1].isZero(0);
  for (Eigen::Index i = 0; has_loads_ && i < roles_.size(); ++i) {
    const Eigen::Index v = i / 3, axis = i % 3;
    at_rest_ += (elements.points(axis, v) - frame_.centroid()[axis]) *
                load_row(loads_, static_cast<Index>(i)).transpose();
  }
}

template <class Real>
void PrecomputedRegion<Real>::place(const Mat3X<Real>& u, Pose& pose) const {
  pose.d.resize(3, rest_.cols());
  for (Eigen::Index i = 0; i < rest_.cols(); ++i)
    pose.d.col(i) = rest_.col(i) + u.col(vertices_[std::size_t(i)]).template cast<double>();
  frame_.fit(pose);
}

template <class Real>
typename PrecomputedRegion<Real>::Amplitudes PrecomputedRegion<Real>::amplitudes(
    Real missing_share, const Mat3<double>& R) const {
  Amplitudes a(amplitudes());
  a.template head<9>() = R.transpose().reshaped();
  a.template tail<9>() = double(missing_share) * a.template head<9>();
  return a;
}

// (14.10) of the theory
template <class Real>
void PrecomputedRegion<Real>::add_forces_in_frame(const Mat3X<Real>& u, Real missing_share, Mat3X<Real>& f,
                                                  Parallel& parallel) {
  if (vertices_.empty()) return;
  place(u, pose_);
  for (Eigen::Index i = 0; i < pose_.d.size(); ++i)
    stiffness_.x()[std::size_t(i)] = static_cast<Real>(pose_.d.data()[i]);
  const std::vector<Real>& product = stiffness_.multiply(parallel);
  for (Eigen::Index i = 0; i < forces_.size(); ++i) forces_.data()[i] = -double(product[std::size_t(i)]);
  Vec3d of_loads = Vec3d::Zero();
  if (has_loads_) {
    const Amplitudes a = amplitudes(missing_share, pose_.R);
    forces_.reshaped().noalias() += of_loads_ * a;
    of_loads = torque_of_loads(a, missing_share);
  }
  frame_.take_off(pose_, frame_.torque(pose_, forces_) - of_loads, forces_);
  for (Eigen::Index i = 0; i < forces_.cols(); ++i)
    f.col(vertices_[std::size_t(i)]) += (pose_.R * forces_.col(i)).template cast<Real>();
}

// Computes τ_f of (14.10) of the theory: the torque of the loads on the interior, about the centroid of the
// interface, in the frame. It follows from the work that each amplitude's load does on the arms of the
// interior, Σ (Y + d)_k f_l.
template <class Real>
Vec3d PrecomputedRegion<Real>::torque_of_loads(const Amplitudes& a, Real missing_share) const {
  const auto count = amplitudes();
  Amplitudes work = at_rest_;
  work.noalias() += of_loads_.transpose() * pose_.d.reshaped();
  work.noalias() -= condensed_->stiffness().topLeftCorner(count, count) * a;
  const Mat3<double> of_amplitudes =
      (work.template head<9>() + double(missing_share) * work.template tail<9>()).reshaped(3, 3);
  Mat3<double> M = Mat3<double>::Zero();
  for (int k = 0; k < 3; ++k) M += of_amplitudes.col(k) * pose_.R.row(k);
  return {M(1, 2) - M(2, 1), M(2, 0) - M(0, 2), M(0, 1) - M(1, 0)};
}

// Displacements in the frame are those of (14.2) of the theory. Velocities include those of the frame, and
// those of the loads as seen from it.
template <class Real>
void PrecomputedRegion<Real>::recover_in_frame(const Elements& elements, Real missing_share, Mat3X<Real>& u,
                                               Mat3X<Real>* v) const {
  Pose pose;
  place(u, pose);
  Mat3X<double> speeds = Mat3X<double>::Zero(3, Eigen::Index(vertices_.size()));
  if (v) speeds = (*v)(Eigen::all, vertices_).template cast<double>();
  const RigidFrame::Rate rate = frame_.rate(pose, speeds);
  Mat3<double> turning;  // Ṙ
  for (int axis = 0; axis < 3; ++axis) turning.col(axis) = pose.R * rate.spin.cross(Vec3d::Unit(axis));
  Eigen::MatrixXd driven(amplitudes() + pose.d.size(), 2);
  driven << amplitudes(missing_share, pose.R), amplitudes(missing_share, turning), pose.d.reshaped(),
      rate.d.reshaped();
  const Eigen::MatrixXd field = condensed_->field(driven);
  for (Index i = 0; i < static_cast<Index>(roles_.cols()); ++i) {
    if (!is_interior(i)) continue;
    const Vec3d Y = elements.points.col(i) - frame_.centroid(), d = field.col(0).segment<3>(3 * i);
    const Vec3d moved =
        (pose.R - Mat3<double>::Identity()) * Y + pose.R * d + (pose.centroid - frame_.centroid());
    u.col(i) = moved.template cast<Real>();
    if (!v) continue;
    v->col(i) = (pose.R * (rate.velocity + rate.spin.cross(Vec3d(Y + d)) + field.col(1).segment<3>(3 * i)))
                    .template cast<Real>();
  }
}

}  // namespace lobe
