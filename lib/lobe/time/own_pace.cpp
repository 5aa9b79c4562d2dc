#include "lobe/time/own_pace.h"

#include <cmath>
#include <initializer_list>
#include <utility>

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

double cost_of(int steps, double share) { return steps * (share + cost_of_step); }

double safety_with_levels(const PatchLimits& limits) { return std::min(limits.safety, safety_of_levels); }

// As `fewest`, with steps up to another share of the stable one.
double fewest_with(double safety, const PatchLimits& limits, int fewest) {
  return fewest * limits.safety / safety;
}

// The longest steps of level 0 with which each patch is stable at each level, and the share of evaluations
// that is at least left with others.
class LongestSteps {
 public:
  LongestSteps(const PatchGraph& graph, const PatchLimits& limits) {
    for (std::size_t p = 0; p < graph.patches.size(); ++p) {
      if (!(graph.patches[p].cost > 0)) continue;
      Steps& steps = patches_.emplace_back();
      steps.cost = graph.patches[p].cost;
      all_ += steps.cost;
      for (Level l = 1; l <= highest_level && !limits.is_fast[p]; ++l)
        steps.of_levels[l] = longest_step(graph, limits, p, l, safety_with_levels(limits));
    }
  }
  double least_share(double dt, Level top) const {
    double evaluated = 0;
    for (const Steps& steps : patches_) {
      Level level = top;
      while (level > 0 && !(dt <= steps.of_levels[level])) --level;
      evaluated += steps.cost / (1 << level);
    }
    return all_ > 0 ? evaluated / all_ : 1;
  }

 private:
  struct Steps {
    double cost = 0;
    LevelRatios of_levels{};  // [s]
  };
  std::vector<Steps> patches_;
  double all_ = 0;
};

// The present levels in one of these numbers of steps, if it is possible and costs less than `enough`.
std::optional<OwnPace> keep_levels(const PatchGraph& graph, const PatchLimits& limits, int fewest,
                                   const std::vector<Level>& levels, std::initializer_list<int> numbers,
                                   double enough) {
  if (levels.size() != graph.patches.size() || levels.empty()) return {};
  const int unit = 1 << *std::max_element(levels.begin(), levels.end());
  const double share = share_of(graph, levels), safety = std::min(limits.safety, safety_to_keep);
  const auto fits = [&](int steps) {
    return steps >= fewest_with(safety, limits, fewest) * (1 - 1e-12) && steps % unit == 0 && share < 1 &&
           cost_of(steps, share) < enough &&
           are_stable(graph, limits, levels, limits.longest * fewest / steps, safety);
  };
  const auto* const steps = std::find_if(numbers.begin(), numbers.end(), fits);
  if (steps == numbers.end()) return {};
  return OwnPace{*steps, levels, share};
}

int in_large_steps(const PatchLimits& limits, int fewest, const std::vector<Level>& levels) {
  if (levels.empty()) return fewest;
  return rounded_up(fewest_with(safety_with_levels(limits), limits, fewest),
                    *std::max_element(levels.begin(), levels.end()));
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
    while (level > 0 && !(dt <= longest_step(graph, limits, p, level, safety_with_levels(limits)))) --level;
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
  const double together = cost_of(fewest, 1);
  const double least_steps = fewest_with(safety_with_levels(limits), limits, fewest);
  const LongestSteps longest(graph, limits);
  OwnPace best{.steps = fewest};
  double least = worth_it * together;
  for (Level top = 1; top <= highest_level; ++top) {
    int last = 0;
    for (int k = 0; k <= 16; ++k) {
      const int steps = rounded_up(least_steps * std::exp2(k / 16.0), top);
      if (steps == last || steps > 2 * least_steps + (1 << top)) continue;
      last = steps;
      const double dt = limits.longest * fewest / steps;
      if (cost_of(steps, longest.least_share(dt, top)) >= least) continue;
      std::vector<Level> levels = levels_of_patches(graph, limits, dt, top);
      const double share = share_of(graph, levels), cost = cost_of(steps, share);
      if (*std::max_element(levels.begin(), levels.end()) < top || cost >= least) continue;
      least = cost;
      best = {steps, std::move(levels), share};
    }
  }
  const double enough = best.levels.empty() ? together : std::min(worth_a_change * least, together);
  const int in_these = in_large_steps(limits, fewest, present.levels);
  const auto kept =
      keep_levels(graph, limits, fewest, present.levels, {present.steps, best.steps, in_these}, enough);
  return kept ? *kept : best;
}

std::optional<OwnPace> keep_pace(const PatchGraph& graph, const PatchLimits& limits, int fewest,
                                 const PresentPace& present) {
  if (present.levels.empty()) return OwnPace{.steps = fewest};
  return keep_levels(graph, limits, fewest, present.levels,
                     {present.steps, in_large_steps(limits, fewest, present.levels)}, cost_of(fewest, 1));
}

}  // namespace lobe
