#include "lobe/body/hold_springs.h"

#include <algorithm>

namespace lobe {

double hold_stiffness(const Elements& elements, const HeldVertices::Held& item) {
  double K = 0;
  for (const Index t : elements.topology.around(item.vertex)) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const Shape s = elements.shape_of(t);
    const Elastic& elastic = elements.elastic_of(t);
    for (int c = 0; c < 4; ++c)
      if (corners[c] == item.vertex)
        K += s.volume * s.gradients.col(c).squaredNorm() * ((elastic.lambda + elastic.mu) / 3 + elastic.mu);
  }
  return K * item.share / (1 - item.share);
}

namespace {

Axes free_axes(const HeldVertices& held, const HeldVertices::Held& item) {
  Axes axes = item.axes;
  if (!held.holds(item.vertex)) return axes;
  for (const HeldVertices::Held& other : held.all())
    if (other.vertex == item.vertex)
      for (int i = 0; i < 3; ++i) axes[i] = axes[i] && !other.axes[i];
  return axes;
}

template <class Real>
Vec3d stretch(const typename HoldSprings<Real>::Spring& spring, const Mat3X<Real>& u) {
  Vec3d along = spring.target - u.col(spring.item.vertex).template cast<double>();
  for (int i = 0; i < 3; ++i)
    if (!spring.item.axes[i]) along[i] = 0;
  return along;
}

}  // namespace

template <class Real>
void HoldSprings<Real>::follow(const Model& model) {
  if (is_current(model.revisions)) return;
  structure_ = model.revisions.structure;
  inertia_ = model.revisions.inertia;
  aimed_at_.reset();
  springs_.clear();
  pulls_.clear();
  for (const Held& item : model.held.partly()) {
    Spring& spring = springs_.emplace_back(Spring{item, hold_stiffness(model.elements, item)});
    spring.item.axes = free_axes(model.held, item);
    const auto same = std::find_if(pulls_.begin(), pulls_.end(),
                                   [&](const Pull& pull) { return pull.vertex == item.vertex; });
    spring.pull = std::size_t(same - pulls_.begin());
    if (same == pulls_.end()) pulls_.push_back({item.vertex});
  }
}

template <class Real>
Vec3d HoldSprings<Real>::target(const Held& item) const {
  const auto same = std::find_if(springs_.begin(), springs_.end(), [&](const Spring& spring) {
    return spring.item.vertex == item.vertex && spring.item.holder == item.holder;
  });
  return same == springs_.end() ? item.start : same->target;
}

template <class Real>
Vec3d HoldSprings<Real>::force_now(const Spring& spring, const Mat3X<Real>& u) const {
  return spring.stiffness * stretch<Real>(spring, u);
}

// Several springs may draw one vertex, along other axes. Their forces are found with f before any is added.
template <class Real>
void HoldSprings<Real>::apply(const std::vector<double>& inverse_mass, double step, const Mat3X<Real>& u,
                              Mat3X<Real>& f) {
  for (Pull& pull : pulls_) {
    pull.force = f.col(pull.vertex).template cast<double>();
    pull.stiffness.setZero();
  }
  for (const Spring& spring : springs_) {
    Pull& pull = pulls_[spring.pull];
    pull.force += force_now(spring, u);
    for (int i = 0; i < 3; ++i)
      if (spring.item.axes[i]) pull.stiffness[i] += spring.stiffness;
  }
  for (Pull& pull : pulls_) {
    const double quarter = inverse_mass[std::size_t(pull.vertex)] * step * step / 4;
    pull.force = pull.force.cwiseQuotient((1 + quarter * pull.stiffness.array()).matrix());
    f.col(pull.vertex) = pull.force.template cast<Real>();
    pull.lag = quarter * pull.force;  // ū − u
  }
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    Spring& spring = springs_[i];
    Vec3d ahead = stretch<Real>(spring, u) - pulls_[spring.pull].lag;
    for (int axis = 0; axis < 3; ++axis)
      if (!spring.item.axes[axis]) ahead[axis] = 0;
    spring.force = spring.stiffness * ahead;
  }
}

template <class Real>
double HoldSprings<Real>::energy(const Mat3X<Real>& u) const {
  double sum = 0;
  for (const Spring& spring : springs_) sum += spring.stiffness * stretch<Real>(spring, u).squaredNorm() / 2;
  return sum;
}

template class HoldSprings<float>;
template class HoldSprings<double>;

}  // namespace lobe
