// A tangle that is made linear until it comes undone (theory, section 8). Part of a checkpoint.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct Unravelling {
  // Tetrahedra that become linear with the tangle, at each stage: so many rings of neighbours around what it has come
  // to; at the last all that hangs together with it.
  static constexpr std::array<int, 4> rings{1, 2, 4, std::numeric_limits<int>::max()};
  static constexpr int stages = static_cast<int>(rings.size());

  std::vector<Index> tets;  // tensor-mass for now, sorted; none: nothing is being unravelled
  int stage = 0;     // stages that were tried since the body was last held or set by somebody, up to `stages`
  double since = 0;  // when the present stage, or the tangle, began [s]
  bool is_lumped = false;  // selective masses wait until nothing is crushed

  bool is_on() const { return !tets.empty(); }
};

}  // namespace lobe
