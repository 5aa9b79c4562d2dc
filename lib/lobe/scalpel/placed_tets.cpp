#include "lobe/scalpel/placed_tets.h"

#include <algorithm>

namespace lobe {

PlacedTets::PlacedTets(const Grains& grains, const std::vector<Index>& tets, Placements find,
                       const CornerPlaces& corners)
    : find_(std::move(find)) {
  placed_.reserve(tets.size());
  grains_.reserve(2 * tets.size());
  for (Index t : tets) {
    const auto begin = static_cast<Index>(grains_.size());
    const std::span<const Index> of_tet = grains.of(t);
    Placed& placed =
        placed_.emplace_back(Placed{t, begin, begin + static_cast<Index>(of_tet.size()), false, {}});
    placed.is_whole = of_tet.size() == 1 && grains[of_tet[0]].share == 1;
    if (placed.is_whole && corners) {
      grains_.push_back({of_tet[0], corners(t)});
      continue;
    }
    const Placement& placement = of(placed);
    for (Index grain : of_tet) {
      const Eigen::Vector4i& points = grains[grain].points;
      Mat34<double>& x = grains_.emplace_back(PlacedGrain{grain, {}}).x;
      for (int k = 0; k < 4; ++k) x.col(k) = placement(grains.point(points[k]));
    }
  }
}

Placement PlacedTets::of(Index tet) const {
  const auto at = std::lower_bound(placed_.begin(), placed_.end(), tet,
                                   [](const Placed& placed, Index t) { return placed.tet < t; });
  return at != placed_.end() && at->tet == tet ? of(*at) : find_(tet);
}

}  // namespace lobe
