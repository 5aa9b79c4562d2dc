// Where the grains of some tetrahedra are now.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lobe/scalpel/grains.h"

namespace lobe {

// The place of a tetrahedron of the simulation: an affine map.
struct Placement {
  Vec3d start, image;     // places of corner 0, at rest and now [m]
  Mat3<double> gradient;  // F
  Vec3d operator()(const Vec3d& X) const { return image + gradient * (X - start); }
};
using Placements = std::function<Placement(Index element)>;
using CornerPlaces = std::function<Mat34<double>(Index element)>;  // present corners [m]

// Tetrahedra in ascending order, each with where its grains are.
class PlacedTets {
 public:
  // Asks only for the corners of tetrahedra that nothing has divided; without `corners`, for the map.
  PlacedTets(const Grains& grains, const std::vector<Index>& tets, Placements find,
             const CornerPlaces& corners = {});

  struct Placed {
    Index tet;
    Index begin, end;  // range of its grains
    bool is_whole;
    mutable std::optional<Placement> placement;  // map, found when it is asked for
  };
  struct PlacedGrain {
    Index grain;
    Mat34<double> x;  // places of its points [m]
  };
  auto begin() const { return placed_.begin(); }
  auto end() const { return placed_.end(); }
  std::size_t size() const { return placed_.size(); }
  const Placed& operator[](std::size_t i) const { return placed_[i]; }
  const Placement& of(const Placed& placed) const {
    if (!placed.placement) placed.placement = find_(placed.tet);
    return *placed.placement;
  }
  Placement of(Index tet) const;  // `tet`: any tetrahedron
  // The grains as they were when they were placed.
  std::span<const PlacedGrain> grains() const { return grains_; }
  std::span<const PlacedGrain> grains_of(const Placed& tet) const {
    return {grains_.data() + tet.begin, grains_.data() + tet.end};
  }

 private:
  std::vector<Placed> placed_;
  std::vector<PlacedGrain> grains_;
  Placements find_;
};

}  // namespace lobe
