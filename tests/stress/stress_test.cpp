// The part of `lobe bench stress --quick` that fits a test: every plan on the small box, in both precisions.
#include <doctest/doctest.h>

#include "benchmarks/stress/play.h"

using namespace lobe::stress;

namespace {

// What docs/stability.md does not guarantee is left to the table: whether a tangle unravels.
bool not_guaranteed(const Plan& plan, const Verdict& verdict) {
  const bool partly_linear =
      plan.model == "mixed" || plan.model == "precomputed" || plan.model == "corotated";
  const bool tangle = plan.name == "randomised" || plan.name == "collapsed to a point" ||
                      (plan.name == "mirrored" && partly_linear) ||
                      (plan.name == "collapsed to a plane" && plan.model == "corotated");
  return tangle && (verdict.why == "a tetrahedron stays inverted or crushed" ||
                    verdict.why == "does not come back to rest");
}

}  // namespace

TEST_CASE_TEMPLATE("every plan ends as it must", Real, float, double) {
  for (const Plan& plan : all_plans(true)) {
    if (plan.body != "box") continue;
    const Verdict verdict = play<Real>(plan);
    CHECK_MESSAGE((verdict.passed || not_guaranteed(plan, verdict)), plan.name, ", ", plan.model, ": ",
                  verdict.why);
  }
}
