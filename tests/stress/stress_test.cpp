// The part of `lobe bench stress --quick` that fits a test: every plan on the small box, in both precisions.
// Of smoothed tetrahedra two models; `./dev stress` plays all.
#include <doctest/doctest.h>

#include "benchmarks/stress/play.h"

using namespace lobe::stress;

TEST_CASE_TEMPLATE("every plan ends as it must", Real, float, double) {
  for (const Plan& plan : all_plans(true)) {
    if (plan.body != "box") continue;
    const bool is_smoothed = kind_of(plan.model) != plan.model;
    if (is_smoothed && plan.model != "smoothed nonlinear" && plan.model != "smoothed mixed") continue;
    const Verdict verdict = play<Real>(plan);
    CHECK_MESSAGE(verdict.passed, plan.name, ", ", plan.model, ": ", verdict.why);
  }
}
