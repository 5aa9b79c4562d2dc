#include "lobe/region/compiled_terms.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/fem/elements.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

using namespace lobe;

namespace {

Terms terms_of(MaterialLaw law, bool fibre, double volume_penalty, double guard_below, double pressure) {
  Elastic elastic;
  elastic.law = law;
  if (fibre) elastic.fibre.stretch = 1e4;
  return nonlinear_law(elastic, volume_penalty, guard_below, pressure).terms;
}

}  // namespace

TEST_CASE("a kernel is compiled for the law of every material that a scene can have") {
  for (double volume : {0.0, 1e5})
    for (double guard : {0.0, 0.2}) {
      for (bool fibre : {false, true})
        for (double pressure : {0.0, 10.0})
          CHECK(is_covered(terms_of(MaterialLaw::svk, fibre, volume, guard, pressure)));
      for (int law = 0; law < law_count; ++law)
        for (double pressure : {0.0, 10.0})
          CHECK(is_covered(terms_of(MaterialLaw(law), false, volume, guard, pressure)));
    }
}

TEST_CASE("each law has its kernels once, with all terms that its materials may have") {
  const auto times = [](const auto& list, const Terms& terms) {
    return std::count(list.begin(), list.end(), terms);
  };
  for (int law = 0; law < law_count; ++law) {
    CAPTURE(law);
    for (const bool volume : {false, true})
      CHECK(times(compiled_terms, {.solid = MaterialLaw(law), .volume = volume}) == 1);
    CHECK(times(compiled_terms, {.solid = MaterialLaw(law), .volume = true, .pressure = true}) == 1);
    for (const bool pressure : {false, true})
      CHECK(times(smoothed_terms, {.solid = MaterialLaw(law), .pressure = pressure}) == 1);
  }
  CHECK(times(smoothed_terms, {.solid = MaterialLaw::corotational}) == 1);
}

TEST_CASE("a law of other terms is not covered") {
  CHECK_FALSE(is_covered(terms_of(MaterialLaw::neo_hookean, true, 0, 0, 0)));
  CHECK_FALSE(is_covered({.solid = MaterialLaw::corotational, .pressure = true}));
  CHECK_FALSE(covers({}, {.volume = true}));
  CHECK(covers({.volume = true}, {.guard = true}));
  CHECK_FALSE(covers({.fibre = true}, {}));
}
