#include "lobe/time/own_pace.h"

#include <cmath>

namespace lobe {
namespace {

double longest_step(const PatchGraph& graph, const PatchLimits& limits, std::size_t p, Level level,
                    double safety) {  // of level 0 [s]
  const double ratio = limits.ratios[level] * (level > graph.patches[p].pace ? unmeasured_ratio : 1);
  return 2 * safety / (ratio * std::sqrt(limits.squares[p]) * (1 << level));
}

double share_of(const PatchGraph& graph, const std::vector<Level>& levels) {
  double evaluated = 0, all = 0;
  for (std::size_t p = 0; p < levels.size(); ++p) {
    evaluated += graph.patches[p].cost / (1 << levels[p]);
    all += graph.patches[p].cost;
  }
  return all > 0 ? evaluated / all : 1;
}

int rounded_up(double steps, Level top) {
  const int unit = 1 << top;
  return unit * static_cast<int>(std::ceil(steps / unit * (1 - 1e-12)));
}

}  // namespace

bool are_stable(const PatchGraph& graph, const PatchLimits& limits, const std::vector<Level>& levels,
                double dt, double safety) {
  for (std::size_t p = 0; p < levels.size(); ++p) {
    if (levels[p] == 0 || !(graph.patches[p].cost > 0)) continue;
    if (limits.is_fast[p] || !(dt <= longest_step(graph, limits, p, levels[p], safety))) return false;
  }
  return true;
}

std::vector<Level> levels_of_patches(const PatchGraph& graph, const PatchLimits& limits, double dt,
                                     Level top) {
  std::vector<Level> levels(graph.patches.size(), top);
  Level of_tied = top;
  for (std::size_t p = 0; p < levels.size(); ++p) {
    if (!(graph.patches[p].cost > 0)) continue;
    Level& level = levels[p];
    if (limits.is_fast[p]) level = 0;
    while (level > 0 && !(dt <= longest_step(graph, limits, p, level, limits.safety))) --level;
    if (graph.patches[p].is_tied) of_tied = std::min(of_tied, level);
  }
  for (bool changed = true; changed;) {  // tied ones may be lowered by their neighbours
    changed = false;
    for (std::size_t p = 0; p < levels.size(); ++p)
      if (graph.patches[p].is_tied) levels[p] = std::min(levels[p], of_tied);
    for (Level level = 0; level + 1 < top; ++level)
      for (std::size_t p = 0; p < levels.size(); ++p)
        if (levels[p] == level && graph.patches[p].cost > 0)
          for (Index q : graph.neighbours[p])
            levels[std::size_t(q)] = std::min(levels[std::size_t(q)], Level(level + 1));
    for (std::size_t p = 0; p < levels.size(); ++p)
      if (graph.patches[p].is_tied && levels[p] < of_tied && graph.patches[p].cost > 0) {
        of_tied = levels[p];
        changed = true;
      }
  }
  for (std::size_t p = 0; p < levels.size(); ++p)
    if (!(graph.patches[p].cost > 0)) levels[p] = 0;
  return levels;
}

OwnPace choose_pace(const PatchGraph& graph, const PatchLimits& limits, int fewest,
                    const PresentPace& present) {
  const auto cost_of = [](int steps, double share) { return steps * (share + cost_of_step); };
  const double together = cost_of(fewest, 1);
  OwnPace best{.steps = fewest};
  double least = worth_it * together;
  for (Level top = 1; top <= highest_level; ++top) {
    int last = 0;
    for (int k = 0; k <= 16; ++k) {
      const int steps = rounded_up(fewest * std::exp2(k / 16.0), top);
      if (steps == last || steps > 2 * fewest + (1 << top)) continue;
      last = steps;
      std::vector<Level> levels = levels_of_patches(graph, limits, limits.longest * fewest / steps, top);
      const double share = share_of(graph, levels), cost = cost_of(steps, share);
      if (*std::max_element(levels.begin(), levels.end()) < top || cost >= least) continue;
      least = cost;
      best = {steps, std::move(levels), share};
    }
  }
  if (present.levels.size() != graph.patches.size() || present.levels.empty()) return best;
  const Level top = *std::max_element(present.levels.begin(), present.levels.end());
  const double share = share_of(graph, present.levels);
  const double enough = best.levels.empty() ? together : std::min(worth_a_change * least, together);
  const auto keeps = [&](int steps) {
    return steps >= fewest && steps % (1 << top) == 0 && share < 1 && cost_of(steps, share) < enough &&
           are_stable(graph, limits, present.levels, limits.longest * fewest / steps, limits.safety);
  };
  for (const int steps : {present.steps, best.steps, rounded_up(fewest, top)})
    if (keeps(steps)) return {steps, present.levels, share};
  return best;
}

}  // namespace lobe
