// How the pre-computed region is condensed: at first; by another thread while it is used; and from scratch,
// where edits have left too large an error.
#include <algorithm>
#include <utility>

#include "lobe/condense/interface_size.h"
#include "lobe/condense/precomputed.h"
#include "lobe/error.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr double most_error = 1e-10;  // largest relative error that edits may leave

// Adds the constants of the linearised forces to the first column, which has all components.
void add_constants(const Linearisation& linearisation, const Elements& elements, Eigen::MatrixXd& loads) {
  if (linearisation.is_at_rest()) return;
  const auto add = [&](const auto& linear, const auto& vertices) {
    Eigen::Index i = 0;
    for (Index v : vertices)
      for (int axis = 0; axis < 3; ++axis) loads(3 * v + axis, 0) += linear.constant[i++];
  };
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.is_in(RegionModel::precomputed, t)) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    add(linearisation.forces(elements, t, corners), corners);
  }
  const SmoothedEdges domains(elements, RegionModel::precomputed);
  for (Index e = 0; e < domains.count(); ++e)
    if (domains[e].volume > 0) add(linearisation.forces(elements, domains[e]), domains[e].vertices);
}

// Condenses the region as it is now; none if it cannot be condensed.
std::unique_ptr<CondensedRegion> condensed_anew(const Elements& elements, const Roles& roles,
                                                const Linearisation& linearisation,
                                                const std::vector<Index>& interface, Eigen::MatrixXd loads,
                                                const SparseFactorMaker& make_factor) {
  add_constants(linearisation, elements, loads);
  CondensingLog unread;
  try {
    return std::make_unique<CondensedRegion>(RegionFactor(elements, roles, linearisation), interface, loads,
                                             unread, make_factor);
  } catch (const InputError&) {
    return nullptr;
  }
}

}  // namespace

// Measures the error that edits have left, so seldom that this costs little compared with the edits. If the
// error is too large, the region is condensed from scratch at once, if that is possible. (Little of it is
// left then.) If another thread is condensing, this waits for it, and then starts it again.
template <class Real>
void PrecomputedRegion<Real>::keep_exact(const Elements& elements, const std::vector<Index>& edited) {
  edited_ += static_cast<Index>(edited.size());
  if (4 * edited_ < condensed_->touched()) return;
  edited_ = 0;
  if (condensed_->error() <= most_error) return;
  auto afresh = condensed_anew(elements, roles_, linearisation_, interface(), loads(), make_factor_);
  if (!afresh) return;
  take(std::move(afresh));
  if (!is_condensing()) return;
  recondensed_.wait();
  begin_condensing(elements, std::move(recondensed_linearisation_));
}

template <class Real>
std::vector<Index> PrecomputedRegion<Real>::interface() const {
  std::vector<Index> components;
  for (Eigen::Index i = 0; i < roles_.size(); ++i)
    if (roles_.data()[i] == Role::interface) components.push_back(static_cast<Index>(i));
  return components;
}

template <class Real>
Eigen::MatrixXd PrecomputedRegion<Real>::loads() const {
  Eigen::MatrixXd loads(roles_.size(), amplitudes());
  for (Eigen::Index i = 0; i < roles_.size(); ++i) loads.row(i) = load_row(loads_, static_cast<Index>(i));
  return loads;
}

// The loads on a component, one for each amplitude.
template <class Real>
Eigen::RowVectorXd PrecomputedRegion<Real>::load_row(const Loads& loads, Index component) const {
  const Index v = component / 3, axis = component % 3;
  if (!has_frame_) return Eigen::RowVector2d(loads[0](axis, v), loads[1](axis, v));
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(amplitudes());
  for (Index set = 0; set < 2; ++set)
    for (Index l = 0; l < 3; ++l) row[9 * set + 3 * l + axis] = loads[std::size_t(set)](l, v);
  return row;
}

template <class Real>
void PrecomputedRegion<Real>::take(std::unique_ptr<CondensedRegion> condensed) {
  condensed_ = std::move(condensed);
  most_touched_ = 2 * condensed_->touched() + 150;
}

template <class Real>
void PrecomputedRegion<Real>::build(const Elements& elements) {
  const std::vector<Index> components = interface();
  refuse_interface(static_cast<Index>(components.size()));
  take(std::make_unique<CondensedRegion>(RegionFactor(elements, roles_, linearisation_), components, loads(),
                                         log_, make_factor_));
}

template <class Real>
void PrecomputedRegion<Real>::begin_condensing(const Elements& elements, Linearisation linearisation) {
  condensed_->record();
  recondensed_is_outdated_ = false;
  recondensed_linearisation_ = std::move(linearisation);
  recondensed_ = std::async(
      std::launch::async, [elements, roles = roles_, components = interface(), loads = loads(),
                           make_factor = make_factor_, linearisation = recondensed_linearisation_] {
        auto condensed = condensed_anew(elements, roles, linearisation, components, loads, make_factor);
        if (condensed) {
          condensed->inertia(interior_masses(elements, roles), shared_components(elements, roles));
          condensed->unit_inertia_error();
        }
        return condensed;
      });
}

template <class Real>
bool PrecomputedRegion<Real>::end_condensing(const Elements& elements) {
  std::unique_ptr<CondensedRegion> condensed = recondensed_.get();
  if (!condensed || recondensed_is_outdated_ ||
      !condensed_->repeat_on(*condensed)) {  // rounding may make a part loose in only one of the two
    most_touched_ *= 2;
    condensed_->forget_operations();
    return false;
  }
  linearisation_ = std::move(recondensed_linearisation_);
  is_outdated_ = false;
  take(std::move(condensed));
  prepare_step(elements);
  return true;
}

template <class Real>
void PrecomputedRegion<Real>::prepare_step(const Elements& elements) {
  const Eigen::MatrixXd& S = condensed_->stiffness();
  const auto n = static_cast<Index>(S.rows() - amplitudes());
  stiffness_.set(S.bottomRightCorner(n, n));
  of_loads_ = -S.bottomLeftCorner(n, amplitudes());
  components_ = condensed_->interface();
  vertices_.clear();
  for (Index component : components_)
    if (vertices_.empty() || vertices_.back() != component / 3) vertices_.push_back(component / 3);
  shared_.clear();
  for (Index v : vertices_) {
    const auto around = elements.topology.around(v);
    if (std::any_of(around.begin(), around.end(), [&](Index t) { return !member_[t]; })) shared_.push_back(v);
  }
  sort_unique(shared_);
  if (has_frame_) prepare_frame(elements);
}

}  // namespace lobe
