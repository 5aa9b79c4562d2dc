// Precomputed regions that are non-linear for a while, and linearised anew about where the body then is (theory, section 15).
#include <algorithm>

#include "lobe/error.h"
#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
void World<Real>::expand() {
  if (!setup_.expandable) throw InputError("region", "the setup does not say that it may be expanded");
  if (is_expanded_ || precomputed_.tet_count() == 0) return;
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
  refresh_vertices(vertices);
  if (!is_expanded_) {
    precomputed_.take_over_loads(external_.padded(), dead_loads_.padded());
    precomputed_.move_mass(elements_, mass_);
    for (Index v : vertices) refresh_inverse_mass(v);
  }
  sleep_.wake_all(state_.time);
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

template void World<float>::expand();
template void World<double>::expand();
template void World<float>::condense();
template void World<double>::condense();
template void World<float>::renew(double);
template void World<double>::renew(double);
template double World<float>::lag() const;
template double World<double>::lag() const;
template void World<float>::set_expanded(bool);
template void World<double>::set_expanded(bool);

}  // namespace lobe
