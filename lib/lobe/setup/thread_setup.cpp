#include "lobe/setup/thread_setup.h"

#include <algorithm>
#include <cmath>

namespace lobe {

void ThreadMaterial::check(const Expect& expect, const std::string& whose) const {
  expect(std::isfinite(stiffness) && stiffness > 0, whose + " needs a stiffness above 0 N, and finite");
  expect(std::isfinite(friction) && friction >= 0, whose + " needs a friction of at least 0, and finite");
  expect(strength > 0, whose + " needs a strength above 0 N");
  expect(holds > 0, whose + " needs tissue that holds more than 0 N");
}

void TieSetup::check(const Expect& expect, const std::string& whose, std::size_t bites) const {
  expect(from >= 0 && from < to && std::size_t(to) < bites,
         whose + " is tied between bites " + std::to_string(from) + " and " + std::to_string(to) +
             ": they must be two of its " + std::to_string(bites) + ", in their order");
  check(expect, whose);
}

void TieSetup::check(const Expect& expect, const std::string& whose) const {
  expect(from >= 0 && from < to, whose + " is tied between bites that are not two in their order");
  expect(std::isfinite(at), whose + " is tied at a time that is not finite");
  expect(std::isfinite(tighten) && tighten >= 0, whose + " is tightened by less than 0 m");
  expect(std::isfinite(over) && over >= 0, whose + " is tightened in less than 0 s");
}

void StitchSetup::check(const Expect& expect) const {
  const std::string whose = "stitch \"" + name + "\"";
  material.check(expect, whose);
  expect(bites.size() >= 2, whose + " needs at least two bites");
  expect(std::all_of(bites.begin(), bites.end(), [](const EmbeddedPoint& bite) { return bite.is_valid(); }),
         whose + " has a bite whose weights do not have the sum 1");
  expect(std::isfinite(at), whose + " is sewn at a time that is not finite");
  for (std::size_t i = 0; i < ties.size(); ++i) {
    ties[i].check(expect, whose, bites.size());
    expect(ties[i].at >= at, whose + " is tied before it is sewn");
    for (std::size_t k = 0; k < i; ++k)
      expect(ties[i].from >= ties[k].to || ties[k].from >= ties[i].to,
             whose + " has two knots whose loops overlap");
  }
}

void StitchSetup::check_all(const std::vector<StitchSetup>& all, const Body& body, const Expect& expect) {
  for (const StitchSetup& stitch : all) {
    stitch.check(expect);
    for (const EmbeddedPoint& bite : stitch.bites) {
      expect(is_tet(bite.tet, body), "stitch \"" + stitch.name + "\" passes a tetrahedron that there is not");
      expect(!is_tet(bite.tet, body) || can_be_pulled(bite.tet, body),
             "stitch \"" + stitch.name + "\" passes a precomputed region, where nothing can pull");
    }
  }
}

}  // namespace lobe
