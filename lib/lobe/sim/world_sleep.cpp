// Parts of a World that sleep (theory, section 8).
#include <algorithm>
#include <utility>

#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
template <class Visit>
void World<Real>::for_patches(Visit&& visit) {
  tensor_mass_.visit_patches(visit);
  nonlinear_.visit_patches(visit);
  if (is_expanded_) expanded_.visit_patches(visit);
}

// Between the forces of a step and its motion: what is kept belongs to the displacements that there are now.
template <class Real>
void World<Real>::update_sleep() {
  if (!sleep_.is_on()) return;
  if (std::exchange(frame_begins_, false)) fall_asleep();
  wake_pulled();
  if (kept_is_stale_) keep_forces();
}

template <class Real>
void World<Real>::fall_asleep() {
  if (missing_loads(state_.time) > 0) return;
  for (Index v = 0; v < state_.u.count(); ++v)
    if (!sleep_.is_asleep(v) && !is_still(v)) sleep_.stir(v, state_.time);
  const auto rests = [&](Index v) { return sleep_.rests(v, state_.time); };
  for_patches([&](const auto& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p) {
      const std::span<const Index> own = layout.vertices_of(p);
      if (!std::all_of(own.begin(), own.end(), rests)) continue;
      for (Index v : own) {
        if (sleep_.is_asleep(v)) continue;
        sleep_.put_to_sleep(v);
        state_.v.col(v).setZero();
        kept_is_stale_ = true;
      }
    }
  });
}

// A vertex that swings alone by δ has speeds up to ω δ and feels up to m ω² δ; slow swings of many show as a drift.
template <class Real>
bool World<Real>::is_still(Index vertex) const {
  const double square = bounded_square(vertex), move = sleep_.move();
  const double speed = state_.v.col(vertex).template cast<double>().squaredNorm();
  const double force = forces_.col(vertex).template cast<double>().norm();
  const double drift = setup_.sleep / Sleep::calm_time;
  return speed <= std::min(square * move * move, drift * drift) &&
         force * inverse_mass_[vertex] <= square * move / 2;
}

template <class Real>
void World<Real>::wake_pulled() {
  std::vector<Index> pulled;
  for (const Sleep::Watched& own : sleep_.watched)
    if (!(double(forces_.col(own.vertex).norm()) <= own.most)) pulled.push_back(own.vertex);
  if (!pulled.empty()) wake(pulled);
}

// And all patches around them.
template <class Real>
void World<Real>::wake(const std::vector<Index>& vertices) {
  if (!sleep_.any()) return;
  kept_is_stale_ = moving_is_stale_ = true;
  for_patches([&](const auto& layout, const auto&) {
    for (Index v : vertices) {
      if (v >= layout.places().vertex_count()) continue;
      for (Index place : layout.places()[v])
        for (Index own : layout.vertices_of(place / patch_vertices)) sleep_.wake(own, state_.time);
    }
  });
}

template <class Real>
void World<Real>::keep_forces() {
  kept_is_stale_ = false;
  sleep_.wanted.clear();
  sleep_.watched.clear();
  find_moving();
  if (!sleep_.any()) return forget_kept_forces();
  const std::vector<std::uint8_t>& asleep = sleep_.state().asleep;
  std::vector<std::uint8_t> wanted(asleep.size());
  std::transform(asleep.begin(), asleep.end(), wanted.begin(), [](auto a) { return std::uint8_t(a == 0); });
  for_patches([&](const auto& layout, auto& sums) { sums.keep(layout, asleep); });
  for_patches([&](const auto& layout, const auto& sums) { sums.mark_awake(layout, wanted); });
  for (const HeldVertices::Held& item : led_) wanted[item.vertex] = 1;
  if (precomputed_.tet_count() > 0)  // its interface
    for (Index t = 0; t < elements_.topology.tet_count(); ++t)
      if (precomputed_.has(t))
        for (Index v : elements_.topology.corners(t)) wanted[v] = 1;
  for_patches([&](const auto& layout, auto& sums) { sums.add_at(layout, wanted); });
  for (Index v = 0; v < state_.u.count(); ++v) {
    if (!wanted[v]) continue;
    sleep_.wanted.push_back(v);
    if (asleep[v] && inverse_mass_[v] > 0)
      sleep_.watched.push_back({v, bounded_square(v) / inverse_mass_[v] * sleep_.move()});
  }
}

template <class Real>
void World<Real>::forget_kept_forces() {
  for_patches([](const auto&, auto& sums) { sums.forget(); });
}

// The forces from outside, at the vertices whose forces are found.
template <class Real>
void World<Real>::put_loads() {
  if (sleep_.is_on() && kept_is_stale_) forget_kept_forces();
  if (sleep_.any() && !kept_is_stale_) {
    for (Index v : sleep_.wanted) forces_.col(v) = external_.col(v);
    return;
  }
  const double missing = missing_loads(state_.time);
  parallel_.for_ranges(forces_.count(), 16384, [&](Index begin, Index end) {
    auto own = forces_.view().middleCols(begin, end - begin);
    own = external_.view().middleCols(begin, end - begin);
    if (missing > 0) own -= Real(missing) * dead_loads_.view().middleCols(begin, end - begin);
  });
}

template <class Real>
PatchCount World<Real>::patch_count() {
  PatchCount sum;
  for_patches([&](const auto&, const auto& sums) {
    sum.evaluated += sums.count().evaluated;
    sum.skipped += sums.count().skipped;
  });
  return sum;
}

template class World<float>;
template class World<double>;

}  // namespace lobe
