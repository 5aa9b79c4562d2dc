// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/orient.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace lobe::meshing {
namespace {

// A triangle at an edge, and whether it runs along the edge from the lower to the higher vertex.
struct DirectedEdge {
  Index low, high, triangle;
  bool upwards;
};

// Neighbours of each triangle across its three edges, and whether they disagree with it. Empty where an edge
// has other than two triangles.
using Neighbours = std::vector<std::array<std::pair<Index, bool>, 3>>;

Neighbours neighbours_of(const Surface& surface) {
  std::vector<DirectedEdge> uses;
  for (Index t = 0; t < surface.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      uses.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  const auto edge = [](const DirectedEdge& use) { return std::pair(use.low, use.high); };
  std::sort(uses.begin(), uses.end(), [&](const DirectedEdge& a, const DirectedEdge& b) {
    return std::pair(edge(a), a.triangle) < std::pair(edge(b), b.triangle);
  });
  Neighbours neighbours(std::size_t(surface.triangle_count()));
  std::vector<int> found(neighbours.size(), 0);
  for (std::size_t i = 0; i < uses.size(); i += 2) {
    const bool is_pair = i + 1 < uses.size() && edge(uses[i]) == edge(uses[i + 1]) &&
                         (i + 2 == uses.size() || edge(uses[i + 1]) != edge(uses[i + 2]));
    if (!is_pair) return {};
    const bool disagree = uses[i].upwards == uses[i + 1].upwards;
    for (const auto& [of, other] : {std::pair(i, i + 1), std::pair(i + 1, i)}) {
      const auto t = std::size_t(uses[of].triangle);
      if (found[t] == 3) return {};
      neighbours[t][std::size_t(found[t]++)] = {uses[other].triangle, disagree};
    }
  }
  return neighbours;
}

// Which triangles to turn so that all agree with the first; empty where that cannot be.
std::vector<char> to_turn(const Neighbours& neighbours) {
  constexpr char unknown = 2;
  std::vector<char> turns(neighbours.size(), unknown);
  std::vector<Index> queue{0};
  turns[0] = 0;
  for (std::size_t at = 0; at < queue.size(); ++at)
    for (const auto& [other, disagree] : neighbours[std::size_t(queue[at])]) {
      const auto wanted = static_cast<char>(turns[std::size_t(queue[at])] != static_cast<char>(disagree));
      char& known = turns[std::size_t(other)];
      if (known == unknown) {
        known = wanted;
        queue.push_back(other);
      } else if (known != wanted) {
        return {};
      }
    }
  return queue.size() == neighbours.size() ? turns : std::vector<char>{};
}

}  // namespace

std::optional<Surface> turned_outwards(const Surface& surface, Turned& turned) {
  const Neighbours neighbours = neighbours_of(surface);
  if (neighbours.empty()) return {};
  std::vector<char> turns = to_turn(neighbours);
  if (turns.empty()) return {};
  const auto count = static_cast<Index>(std::count(turns.begin(), turns.end(), 1));
  const bool most_turn = 2 * count > surface.triangle_count();  // then the others are the wrong ones
  turned.to_agree = most_turn ? surface.triangle_count() - count : count;
  Surface result = surface;
  for (Index t = 0; t < surface.triangle_count(); ++t)
    if ((turns[std::size_t(t)] == 1) != most_turn) std::swap(result.triangles(1, t), result.triangles(2, t));
  turned.outwards = 0;
  if (enclosed_volume(result) >= 0) return result;
  turned.outwards = surface.triangle_count();
  result.triangles.row(1).swap(result.triangles.row(2));
  return result;
}

}  // namespace lobe::meshing
