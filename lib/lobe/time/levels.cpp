#include "lobe/time/levels.h"

#include "lobe/assert.h"

namespace lobe {

std::vector<Level> levels_of_vertices(const std::vector<double>& squares, double highest) {
  std::vector<Level> levels(squares.size(), 0);
  for (std::size_t v = 0; v < squares.size(); ++v) {
    double square = 4 * squares[v];
    for (; levels[v] < highest_level && square <= highest; square *= 4) ++levels[v];
  }
  return levels;
}

void step_together(const std::vector<std::vector<Index>>& groups, std::vector<Level>& of_vertices) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::vector<Index>& group : groups) {
      Level fastest = highest_level;
      for (Index v : group) fastest = std::min(fastest, of_vertices[std::size_t(v)]);
      for (Index v : group) {
        changed |= of_vertices[std::size_t(v)] != fastest;
        of_vertices[std::size_t(v)] = fastest;
      }
    }
  }
}

double evaluated_share(std::span<const Level> levels, std::span<const double> costs) {
  lobe_assert(costs.empty() || costs.size() == levels.size(), "a part has no cost");
  double evaluated = 0, all = 0;
  for (std::size_t p = 0; p < levels.size(); ++p) {
    const double cost = costs.empty() ? 1 : costs[p];
    evaluated += cost / double(1 << levels[p]);
    all += cost;
  }
  return all > 0 ? evaluated / all : 1;
}

}  // namespace lobe
