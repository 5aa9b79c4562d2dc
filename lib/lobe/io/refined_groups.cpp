#include <algorithm>

#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/refine.h"

namespace lobe {

std::vector<std::array<Index, 3>> refined_triangles(const std::vector<std::array<Index, 3>>& triangles,
                                                    const TetMesh& old, const RefinedMesh& fine) {
  using Corners = std::array<Index, 3>;
  const auto middle = [&](Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    const std::array<Index, 2> edge{low, high};
    const auto at = std::lower_bound(fine.ends.begin(), fine.ends.end(), edge);
    return at != fine.ends.end() && *at == edge ? old.vertex_count() + Index(at - fine.ends.begin()) : -1;
  };
  std::vector<Corners> parts;
  for (const auto& [a, b, c] : triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    if (ab < 0 || bc < 0 || ca < 0) continue;
    for (const Corners& part :
         {Corners{a, ab, ca}, Corners{ab, b, bc}, Corners{ca, bc, c}, Corners{ab, bc, ca}})
      parts.push_back(part);
  }
  return parts;
}

}  // namespace lobe
