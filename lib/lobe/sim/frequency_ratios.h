// How much higher than what a vertex feels alone the highest frequency may be (theory, section 7). Where ω_max is
// measured, no mode around a vertex is above ω_max/ω_v times its own estimate, and those that have more room are not
// taken to use more of it than the vertex of the highest estimate ever did. Part of a checkpoint.
#pragma once

#include <algorithm>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct FrequencyRatios {
  static constexpr int evaluations = 8;           // of all forces, at most, to measure it once more
  static constexpr int apart = 40 * evaluations;  // steps between two measurements: 2.5 % of the time
  static constexpr double worth_measuring = 0.02;  // so much must the limit have changed since

  double most = 1;         // of a vertex of which nothing is known
  std::vector<float> own;  // per vertex, 1 … most
  double limit = 0;        // of the time step, when it was measured [s]
  int wait = apart;        // steps until it may be measured again

  double square(Index v) const { return double(own[std::size_t(v)]) * double(own[std::size_t(v)]); }
  void extend(Index vertices) { own.resize(std::size_t(vertices), static_cast<float>(most)); }
  void forget(Index v) { own[std::size_t(v)] = static_cast<float>(most); }
  void forget_all(double ratio) {  // but that of the highest vertex
    most = ratio;
    std::fill(own.begin(), own.end(), static_cast<float>(ratio));
  }
  template <class Frequency>  // of a vertex, ω_v [rad/s]
  void measured(double omega, double highest_vertex, Frequency&& frequency) {
    most = std::max(most, omega / highest_vertex);
    for (std::size_t v = 0; v < own.size(); ++v) {
      const double alone = frequency(static_cast<Index>(v));
      own[v] = static_cast<float>(alone * most > omega ? std::max(1.0, omega / alone) : most);
    }
  }
};

}  // namespace lobe
