#include "lobe/time/sleep.h"

#include <algorithm>
#include <utility>

#include "lobe/time/dynamics.h"

namespace lobe {

void Sleep::wake_all(double time) {
  count_ = 0;
  state_.asleep.assign(state_.asleep.size(), 0);
  state_.still_since.assign(state_.asleep.size(), time);
  ++revision_;
}

void Sleep::set_state(const State& state) {
  state_ = state;
  count_ = 0;
  for (std::uint8_t asleep : state_.asleep) count_ += asleep;
  ++revision_;
}

template <class Real>
auto Sleep::now(const Dynamics<Real>& body) const -> FoundAt {
  const Revisions& model = body.model.revisions;
  return {model.structure, model.replaced, body.regions.sums_revision(), revision_};
}

template <class Real>
bool Sleep::forces_are_kept(const Dynamics<Real>& body) const {
  return found_at_ == now(body);
}

template <class Real>
const std::vector<Index>* Sleep::begin_forces(Dynamics<Real>& body) {
  if (!is_on()) return nullptr;
  if (!forces_are_kept(body)) body.regions.forget_sums();
  return any() && forces_are_kept(body) ? &evaluated_ : nullptr;
}

template <class Real>
void Sleep::update(Dynamics<Real>& body) {
  if (!is_on()) return;
  if (std::exchange(frame_begins_, false)) fall_asleep(body);
  wake_pulled(body);
  if (!forces_are_kept(body)) keep_forces(body);
}

template <class Real>
void Sleep::fall_asleep(Dynamics<Real>& body) {
  const double time = body.motion.time;
  if (body.loads.missing_share(time) > 0) return;
  for (Index v = 0; v < body.motion.u.count(); ++v)
    if (!is_asleep(v) && !is_still(v, body)) state_.still_since[v] = time;
  const auto rests = [&](Index v) {
    return state_.asleep[v] != 0 || time - state_.still_since[v] >= still_time;
  };
  body.regions.visit_patches([&](const auto& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p) {
      const std::span<const Index> vertices = layout.vertices_of(p);
      if (!std::all_of(vertices.begin(), vertices.end(), rests)) continue;
      for (Index v : vertices) {
        if (is_asleep(v)) continue;
        ++count_;
        ++revision_;
        state_.asleep[v] = 1;
        body.motion.v.col(v).setZero();
      }
    }
  });
}

// A vertex that swings alone by δ has speeds up to ω δ and feels up to m ω² δ; slow swings of many show as a
// drift.
template <class Real>
bool Sleep::is_still(Index vertex, const Dynamics<Real>& body) const {
  const double square = state_.squares[vertex];
  const double speed = body.motion.v.col(vertex).template cast<double>().squaredNorm();
  const double force = body.motion.forces.col(vertex).template cast<double>().norm();
  return speed <= std::min(square * move_ * move_, slowest_drift_ * slowest_drift_) &&
         force * body.inertia.inverse_mass(vertex) <= square * move_ / 2;
}

template <class Real>
void Sleep::wake_pulled(Dynamics<Real>& body) {
  std::vector<Index> pulled;
  for (const BorderVertex& border : border_)
    if (!(double(body.motion.forces.col(border.vertex).norm()) <= border.most))
      pulled.push_back(border.vertex);
  if (!pulled.empty()) wake(pulled, body);
}

template <class Real>
void Sleep::wake(const std::vector<Index>& vertices, Dynamics<Real>& body) {
  if (!any()) return;
  ++revision_;
  body.regions.visit_patches([&](const auto& layout, const auto&) {
    for (Index v : vertices) {
      if (v >= layout.places().vertex_count()) continue;
      for (Index place : layout.places()[v])
        for (Index vertex : layout.vertices_of(place / patch_vertices)) {
          if (!is_asleep(vertex)) continue;
          --count_;
          state_.asleep[vertex] = 0;
          state_.still_since[vertex] = body.motion.time;
        }
    }
  });
}

template <class Real>
void Sleep::keep_forces(Dynamics<Real>& body) {
  evaluated_.clear();
  border_.clear();
  body.find_moving();
  if (any()) {
    const std::vector<std::uint8_t> evaluated = find_evaluated(body);
    for (Index v = 0; v < body.motion.u.count(); ++v) {
      if (!evaluated[v]) continue;
      evaluated_.push_back(v);
      const double inverse_mass = body.inertia.inverse_mass(v);
      if (state_.asleep[v] && inverse_mass > 0)
        border_.push_back({v, state_.squares[v] / inverse_mass * move_});
    }
  } else {
    body.regions.forget_sums();
  }
  found_at_ = now(body);
}

// The vertices whose forces may change: those that are awake, driven or woken by force terms, the
// interface of condensed regions, and their neighbours by patches. Patches that sleep keep their sums from
// here on.
template <class Real>
std::vector<std::uint8_t> Sleep::find_evaluated(Dynamics<Real>& body) {
  std::vector<std::uint8_t> evaluated(state_.asleep.size());
  std::transform(state_.asleep.begin(), state_.asleep.end(), evaluated.begin(),
                 [](auto a) { return std::uint8_t(a == 0); });
  body.regions.visit_patches([&](const auto& layout, auto& sums) { sums.keep(layout, state_.asleep); });
  body.regions.visit_patches(
      [&](const auto& layout, const auto& sums) { sums.mark_awake(layout, evaluated); });
  for (const HeldVertices::Held& item : body.inertia.driven()) evaluated[item.vertex] = 1;
  for (Index v : body.woken_by_terms()) evaluated[v] = 1;
  body.regions.mark_without_patches(body.model.elements, evaluated);
  body.regions.visit_patches([&](const auto& layout, auto& sums) { sums.add_at(layout, evaluated); });
  return evaluated;
}

#define LOBE_INSTANTIATE(Real)                                           \
  template void Sleep::wake(const std::vector<Index>&, Dynamics<Real>&); \
  template void Sleep::update(Dynamics<Real>&);                          \
  template const std::vector<Index>* Sleep::begin_forces(Dynamics<Real>&);
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
