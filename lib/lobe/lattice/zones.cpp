#include "lobe/lattice/zones.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>

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
  if (sight.held != state_.held) keep_full(burst);
  state_.held = sight.held;
  std::vector<Index> touched;
  std::set_union(sight.held.begin(), sight.held.end(), sight.pressed.begin(), sight.pressed.end(),
                 std::back_inserter(touched));
  if (touched != state_.touched) around_is_known_ = false;
  state_.touched = std::move(touched);
  if (state_.touched.empty()) return;
  if (!around_is_known_) find_around(elements, reach * cell);
  state_.until.resize(std::size_t(elements.topology.vertex_count()), lowest);
  for (Index v : around_) state_.until[std::size_t(v)] = time + linger;
}

// As far as each vertex that is touched reaches along edges at rest, and at least to its neighbours: what it
// pulls at is strained most there.
void FullZones::find_around(const Elements& elements, double distance) {
  around_ = state_.touched;
  std::unordered_map<Index, Index> from;  // the vertex that reaches one
  for (Index v : around_) from.emplace(v, v);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const Index own = around_[i], start = from.at(own);
    for (Index t : elements.topology.around(own))
      for (Index v : elements.topology.corners(t)) {
        const bool is_near =
            own == start || (elements.points.col(v) - elements.points.col(start)).norm() <= distance;
        if (is_near && from.emplace(v, start).second) around_.push_back(v);
      }
  }
  around_is_known_ = true;
}

}  // namespace lobe
