#include "lobe/lattice/zones.h"

#include <algorithm>
#include <unordered_map>

namespace lobe {

void FullZones::look(const Elements& elements, double cell, double time, std::vector<Index> touched) {
  if (touched.empty() && state_.touched.empty()) return;
  const bool lets_go =
      !std::includes(touched.begin(), touched.end(), state_.touched.begin(), state_.touched.end());
  if (lets_go) state_.all_until = std::max(state_.all_until, time + burst);
  if (touched != state_.touched) around_is_known_ = false;
  state_.touched = std::move(touched);
  if (!around_is_known_) find_around(elements, reach * cell);
  state_.until.resize(std::size_t(elements.topology.vertex_count()), lowest);
  for (Index v : around_) state_.until[std::size_t(v)] = time + linger;
}

// Along edges, from each vertex that is touched as far as it reaches at rest.
void FullZones::find_around(const Elements& elements, double distance) {
  around_ = state_.touched;
  std::unordered_map<Index, Index> from;
  for (Index v : around_) from.emplace(v, v);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const Index own = around_[i], start = from.at(own);
    for (Index t : elements.topology.around(own))
      for (Index v : elements.topology.corners(t))
        if ((elements.points.col(v) - elements.points.col(start)).norm() <= distance &&
            from.emplace(v, start).second)
          around_.push_back(v);
  }
  around_is_known_ = true;
}

}  // namespace lobe
