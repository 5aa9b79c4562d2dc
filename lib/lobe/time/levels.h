// Levels: how much longer a step parts of a body could take than its stiffest part (theory, section 7, own
// steps). A part of level l gets the kicks of 2^l short steps at once, in every 2^l-th of them. Parts are
// tetrahedra, or patches of them.
//
// World steps by levels with Setup::own_steps (time/own_steps.h). scene/pace.h estimates what they spare.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "lobe/types.h"

namespace lobe {

using Level = std::uint8_t;
inline constexpr Level highest_level = 5;  // 32 short steps

// The level of each vertex by its own frequency: the highest l with 2^l ω_v ≤ ω_max. A vertex that does not
// move by itself, with ω_v = 0, has highest_level.
std::vector<Level> levels_of_vertices(const std::vector<double>& squares,  // ω_v² per vertex [1/s²]
                                      double highest);                     // ω_max² [1/s²]

// Vertices that a force ties or that touch: all of a group step with the fastest of them, also where groups
// have vertices in common.
void step_together(const std::vector<std::vector<Index>>& groups, std::vector<Level>& of_vertices);

// The levels of parts: the highest of which none is above that of one of its vertices, and parts that share a
// vertex differ by at most one. So no part that has a vertex of a stiff one is slower than that vertex
// asks for. Does not depend on the order of parts and vertices. O(levels × vertices of all parts).
template <class VerticesOf>
std::vector<Level> levels_of_parts(Index parts, VerticesOf&& vertices_of,  // (part): a range of vertices
                                   const std::vector<Level>& of_vertices) {
  std::vector<Level> levels(std::size_t(parts), highest_level);
  for (Index p = 0; p < parts; ++p)
    for (Index v : vertices_of(p))
      levels[std::size_t(p)] = std::min(levels[std::size_t(p)], of_vertices[std::size_t(v)]);
  std::vector<Level> around(of_vertices.size(), highest_level);  // lowest of the parts of a vertex
  for (Level level = 0; level + 1 < highest_level; ++level) {
    for (Index p = 0; p < parts; ++p)
      if (levels[std::size_t(p)] == level)
        for (Index v : vertices_of(p)) around[std::size_t(v)] = std::min(around[std::size_t(v)], level);
    for (Index p = 0; p < parts; ++p)
      for (Index v : vertices_of(p))
        if (around[std::size_t(v)] <= level)
          levels[std::size_t(p)] = std::min(levels[std::size_t(p)], Level(level + 1));
  }
  return levels;
}

// The share of evaluations that own steps leave of those of one step for all: the mean of 2^−level.
double evaluated_share(std::span<const Level> levels,
                       std::span<const double> costs);  // cost of each part; empty: all cost the same

}  // namespace lobe
