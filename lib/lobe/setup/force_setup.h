// What the setups of forces need (force_setups.h).
#pragma once

#include <memory>

#include "lobe/fem/body.h"
#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct Setup;
template <class Real>
class ForceTerm;
template <class Real>
using NewTerm = std::shared_ptr<ForceTerm<Real>>;

inline bool is_tet(Index t, const Body& body) { return t >= 0 && t < body.mesh.tet_count(); }
// Whether a force on it moves it: the inside of a pre-computed region follows its interface.
inline bool can_be_pulled(Index t, const Body& body) {
  return is_tet(t, body) && (std::size_t(t) >= body.region_of.size() ||
                             body.region_of[std::size_t(t)] != RegionModel::precomputed);
}

}  // namespace lobe
