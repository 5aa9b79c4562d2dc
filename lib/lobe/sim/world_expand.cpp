// Precomputed regions that are condensed afresh while a World runs, linearised anew about where the body then is, and
// non-linear for a while (theory, section 14).
#include "lobe/error.h"
#include "lobe/sim/world.h"

namespace lobe {

// At a frame's start. The result is taken when it is due, on a slow machine by waiting for it, so that a run is the same
// to the bit on every one.
template <class Real>
void World<Real>::refresh_condensed() {
  constexpr double delay = 1;  // [s]
  if (precomputed_.is_refreshing() && state_.time >= refresh_due_)
    end_refresh();
  else if (precomputed_.wants_refresh())
    begin_refresh(state_.time + delay, {});
}

template <class Real>
void World<Real>::begin_refresh(double due, const std::vector<double>& about) {
  if (about.empty())
    precomputed_.begin_refresh(elements_);
  else
    precomputed_.begin_renewal(elements_, Eigen::Map<const Mat3X<double>>(about.data(), 3, state_.u.count()));
  refresh_due_ = due;
  history_.push_back({Edit::Kind::begin_refresh, {}, {}, {}, due, about});
}

template <class Real>
void World<Real>::end_refresh() {
  catch_up();
  precomputed_.end_refresh(elements_);
  if (!is_expanded_) move_mass({});
  interior_ = Interior::stale;
  known_ = Known::stale;
  history_.push_back({Edit::Kind::end_refresh, {}, {}});
}

template <class Real>
void World<Real>::expand() {
  if (!setup_.expandable) throw InputError("region", "the setup does not say that it may be expanded");
  if (is_expanded_ || precomputed_.tet_count() == 0) return;
  catch_up();
  state();
  set_expanded(true);
  history_.push_back({Edit::Kind::expand, {}, {}});
}

template <class Real>
void World<Real>::condense() {
  if (!is_expanded_) return;
  if (!can_condense())
    throw InputError("region",
                     "it was edited while it was expanded, and must be renewed before it is condensed");
  catch_up();
  interior_ = Interior::stale;
  set_expanded(false);
  history_.push_back({Edit::Kind::condense, {}, {}});
}

// Masses and loads of the region's vertices.
template <class Real>
void World<Real>::set_expanded(bool is_expanded) {
  is_expanded_ = is_expanded;
  std::vector<Index> vertices = precomputed_.shared();
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v)
    if (precomputed_.is_interior(v)) vertices.push_back(v);
  if (setup_.selective_mass > 1)  // those that are held as well
    for (Index t = 0; t < elements_.topology.tet_count(); ++t)
      if (precomputed_.has(t))
        for (Index v : elements_.topology.corners(t)) inertia_edits_.push_back(v);
  refresh_vertices(vertices);
  if (!is_expanded_) {
    precomputed_.take_over_loads(external_.padded(), dead_loads_.padded());
    move_mass(vertices);
  }
  sleep_.wake_all(state_.time);
  ratios_.forget_all(at_rest().ratio);
  kept_is_stale_ = true;
  known_ = Known::stale;
}

template <class Real>
void World<Real>::renew(double delay) {
  if (!(delay > 0)) throw InputError("region", "the delay of its renewal must be above 0 s");
  if (precomputed_.is_refreshing() || precomputed_.tet_count() == 0) return;
  const Mat3X<double> u = displacements().template cast<double>();
  begin_refresh(state_.time + delay, {u.data(), u.data() + u.size()});
}

// The shares of the region's mass are found before.
template <class Real>
double World<Real>::lag() const {
  Vec3d sum = Vec3d::Zero();
  int count = 0;
  for (Index v : precomputed_.shared()) {
    if (inverse_mass_[v] == 0) continue;
    sum += inverse_mass_[v] * forces_.col(v).template cast<double>();
    ++count;
  }
  return count > 0 ? precomputed_.lag(sum / count) : 0;
}

// The mass of the region's interior goes to its shared vertices; `vertices`: others whose masses are new.
template <class Real>
void World<Real>::move_mass(const std::vector<Index>& vertices) {
  for (Index v : precomputed_.move_mass(elements_, mass_)) refresh_inverse_mass(v);
  for (Index v : vertices) refresh_inverse_mass(v);
}

template class World<float>;
template class World<double>;

}  // namespace lobe
