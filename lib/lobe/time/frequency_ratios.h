// Ratios r_v that correct the vertex estimates ω_v [rad/s]: ω_max is taken to be max_v r_v ω_v (theory,
// section 7). When ω_max has been measured, r_v = min(ω_max/ω_v, `most`). `most` is the largest value so
// far of ω_max over the highest estimate. All nodes of a lattice have one ratio. Part of a checkpoint.
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct RestFrequencies {  // frequencies of a body at rest
  double omega = 0;       // the highest [rad/s], with the masses of a degree; 0: it was not measured
  double lumped = 0;      // highest frequency with lumped masses
  double ratio = 1;       // ratio of that to the highest frequency of a single vertex
};

struct FrequencyRatios {
  static constexpr int evaluations = 8;      // evaluations of all forces, at most, to measure it once more
  static constexpr double slightest = 0.02;  // change of the limit that is worth it
  static constexpr int most_steps = static_cast<int>(2 * evaluations / slightest);

  double most = 1;               // ratio of a vertex of which nothing is known
  std::vector<float> of_vertex;  // ratio of each vertex, up to `most`
  double of_nodes = 1;           // ratio of ω_max to the bound of the nodes of a lattice
  double limit = 0;              // limit of the time step when it was measured [s]
  int steps = 0;                 // steps since then, up to most_steps

  bool is_valid() const {
    return most > 0 && std::isfinite(most) && of_nodes > 0 && of_nodes <= 1 && limit >= 0 && steps >= 0 &&
           steps <= most_steps && std::all_of(of_vertex.begin(), of_vertex.end(), [&](float one) {
             return one > 0 && one <= static_cast<float>(most);
           });
  }
  static constexpr auto fields =
      std::tuple(&FrequencyRatios::most, &FrequencyRatios::of_vertex, &FrequencyRatios::of_nodes,
                 &FrequencyRatios::limit, &FrequencyRatios::steps);

  // Whether, over as many steps as were taken since, the change of the limit is worth twice the time of a
  // measurement.
  bool is_worth_measuring(double limit_now) const {
    const double change = std::abs(limit_now / limit - 1);
    return change > slightest && change * steps >= 2 * evaluations;
  }
  void step() { steps = std::min(steps + 1, most_steps); }

  double square(Index v) const {
    return double(of_vertex[std::size_t(v)]) * double(of_vertex[std::size_t(v)]);
  }
  void extend(Index vertices) { of_vertex.resize(std::size_t(vertices), static_cast<float>(most)); }
  void forget(Index v) { of_vertex[std::size_t(v)] = static_cast<float>(most); }
  void forget_all(double ratio) {  // ratio: of the vertex of the highest estimate; all have it now
    most = ratio;
    std::fill(of_vertex.begin(), of_vertex.end(), static_cast<float>(ratio));
  }
  void measured(double omega, const std::vector<double>& estimates,
                double least) {  // ω_max, ω_v of each vertex [rad/s]
    most = std::max(most, omega / *std::max_element(estimates.begin(), estimates.end()));
    for (std::size_t v = 0; v < of_vertex.size(); ++v)
      of_vertex[v] =
          static_cast<float>(estimates[v] * most > omega ? std::max(least, omega / estimates[v]) : most);
  }
};

}  // namespace lobe
