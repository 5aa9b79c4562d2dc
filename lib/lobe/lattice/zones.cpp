#include "lobe/lattice/zones.h"

#include <algorithm>
#include <unordered_map>

#include "lobe/sort_unique.h"

namespace lobe {

namespace {

// Above which a body that swings is quick, of speed over displacement [1/s].
double highest_rate(double damping) {
  constexpr double e = 2.718281828459045;
  const double time = damping > 0 ? std::min(FullZones::longest, 2 / (e * damping)) : FullZones::longest;
  return FullZones::most / (FullZones::share * time);
}

}  // namespace

void FullZones::look(const Elements& elements, double cell, double time, const Sight& sight) {
  const auto keep_full = [&](double while_) { state_.all_until = std::max(state_.all_until, time + while_); };
  state_.largest = std::max(state_.largest, sight.displacement);
  const bool is_quick = sight.speed > highest_rate(sight.damping) * state_.largest;
  if (is_quick && sight.held.empty()) keep_full(quick);
  const bool holds_others = sight.held != state_.held,
             lets_go =
                 !std::includes(sight.held.begin(), sight.held.end(), state_.held.begin(), state_.held.end()),
             is_calm = sight.displacement < calm * state_.largest;
  if (lets_go || (holds_others && !is_calm)) keep_full(burst);
  state_.held = sight.held;
  if (time < state_.all_until - just_before) state_.asked_until.clear();
  std::vector<Index> touched = sight.held;
  for (const std::vector<Index>* list : {&sight.loaded, &sight.pressed})
    touched.insert(touched.end(), list->begin(), list->end());
  sort_unique(touched);
  if (touched != state_.touched || sight.pressed != pressed_) around_is_known_ = false;
  pressed_ = sight.pressed;
  state_.touched = std::move(touched);
  if (state_.touched.empty()) return;
  if (!around_is_known_) find_around(elements, cell);
  state_.until.resize(std::size_t(elements.topology.vertex_count()), lowest);
  // While a tool slides, a zone grows only when the tool comes to its border, and then by all of its reach.
  const bool grows = sight.pressed.empty() || holds_others ||
                     std::any_of(beside_.begin(), beside_.end(), [&](Index v) { return !is_full(v, time); });
  const double until = sight.pressed.empty() ? time + linger : every * std::ceil((time + linger) / every);
  for (Index v : around_)
    if (grows || is_full(v, time)) state_.until[std::size_t(v)] = until;
}

void FullZones::ask(const std::vector<Index>& vertices, Index vertex_count, double until) {
  state_.asked_until.resize(std::size_t(vertex_count), lowest);
  for (Index v : vertices) {
    double& own = state_.asked_until[std::size_t(v)];
    own = std::max(own, every * std::ceil(until / every));
  }
}

std::vector<Index> FullZones::take_due(double time) {
  std::vector<Index> found;
  for (std::size_t v = 0; v < state_.asked_until.size(); ++v) {
    double& own = state_.asked_until[v];
    if (own == lowest || time < own - just_before) continue;
    own = lowest;
    found.push_back(static_cast<Index>(v));
  }
  return found;
}

// As far as each vertex that is touched reaches along edges at rest, and at least to its neighbours: what it
// pulls at is strained most there.
void FullZones::find_around(const Elements& elements, double cell) {
  around_ = beside_ = state_.touched;
  const auto distance_of = [&](Index v) {
    return cell * (std::binary_search(pressed_.begin(), pressed_.end(), v) ? reach_of_press : reach);
  };
  std::unordered_map<Index, Index> from;  // the vertex that reaches one
  for (Index v : around_) from.emplace(v, v);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const Index own = around_[i], start = from.at(own);
    const double distance = distance_of(start);
    for (Index t : elements.topology.around(own))
      for (Index v : elements.topology.corners(t)) {
        const bool is_near =
            own == start || (elements.points.col(v) - elements.points.col(start)).norm() <= distance;
        if (!is_near || !from.emplace(v, start).second) continue;
        around_.push_back(v);
        if (own == start) beside_.push_back(v);
      }
  }
  around_is_known_ = true;
}

}  // namespace lobe
