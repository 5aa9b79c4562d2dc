// The interior of a pre-computed region has no mass. So the region is expanded when something presses on its
// interior, and condensed again when nothing has for a while.
#pragma once

#include <cmath>
#include <tuple>
#include <utility>

#include "lobe/forces/regions.h"

namespace lobe {

struct TouchExpansion {
  static constexpr double patience = 0.5;  // untouched for so long, it is condensed again [s]
  bool has_expanded = false;
  bool is_lost = false;  // whether the report has said that forces have no effect
  double last = 0;       // time of the last touch [s]

  // Returns what the world must do now. `is_pressed`: whether a force acts on the interior of the region.
  // `time`: time of the world [s]. report: say once that such forces have no effect: it cannot be expanded.
  enum class Answer { nothing, expand, condense, report };
  template <class Real>
  Answer follow(const Regions<Real>& regions, bool is_pressed, double time) {
    if (is_pressed) last = time;
    if (is_pressed && regions.may_expand()) {
      has_expanded = true;
      return Answer::expand;
    }
    if (!regions.is_expanded())
      return is_pressed && !std::exchange(is_lost, true) ? Answer::report : Answer::nothing;
    if (!has_expanded || !(time > last + patience) || !regions.can_condense()) return Answer::nothing;
    has_expanded = false;
    return Answer::condense;
  }

  bool is_valid() const { return std::isfinite(last); }
  static constexpr auto fields =
      std::tuple(&TouchExpansion::has_expanded, &TouchExpansion::is_lost, &TouchExpansion::last);
};

}  // namespace lobe
