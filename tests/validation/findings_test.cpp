#include "benchmarks/validation/findings.h"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "benchmarks/benchmarks.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/table.h"
#include "lobe/error.h"
#include "near.h"

using namespace lobe::validation;
using namespace lobe::test;

TEST_CASE("a row passes within its tolerance, fails beyond it, and fails if it is not a number") {
  lobe::validation::Findings findings("f");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  findings.value("a", "q", "m", 1.0099, {1, ""}, {0.01, ""});
  findings.value("a", "q", "m", 0.9899, {1, ""}, {0.01, ""});
  findings.value("a", "q", "m", -2e-9, {0, ""}, {1e-9, ""});
  findings.value("a", "q", "m", nan, {1, ""}, {0.01, ""});
  findings.order("a", "q", 1.91, 2, {0.1, ""});
  findings.order("a", "q", 2.5, 2, {0.1, ""});
  findings.order("a", "q", 1.89, 2, {0.1, ""});
  findings.order("a", "q", nan, 2, {0.1, ""});
  findings.failure("the reason");
  const bool expected[] = {true, false, false, false, true, true, false, false, false};
  REQUIRE(findings.rows().size() == std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) CHECK(findings.rows()[i].passed == expected[i]);
  CHECK(text_line(findings.rows().back()).find("FAILED") != std::string::npos);
}

TEST_CASE("what a family throws is a failed row, after those it had found") {
  const Family family{"f", [](lobe::validation::Findings& findings, bool) {
                        findings.value("a", "q", "m", 1, {1, ""}, {0.01, ""});
                        throw std::runtime_error("no equilibrium");
                      }};
  const lobe::validation::Findings findings = run_family(family, true);
  REQUIRE(findings.rows().size() == 2);
  CHECK(findings.rows()[0].passed);
  CHECK(!findings.rows()[1].passed);
  CHECK(csv(findings.rows()).find("no equilibrium") != std::string::npos);
}

TEST_CASE("a family that does not exist is named, with those that do") {
  lobe::bench::Options options;
  options.family = "silicon beam";
  try {
    lobe::bench::bench_validation(options);
    FAIL("it was run");
  } catch (const lobe::InputError& error) {
    const std::string message = error.what();
    CHECK(message.find("silicon beam: no such family") != std::string::npos);
    CHECK(message.find("silicone beam in motion") != std::string::npos);
  }
}

TEST_CASE("orders and limits of known sequences are found") {
  CHECK(observed_order({0.4, 0.2, 0.1}, {9.0, 0.08, 0.02}) == near(2, 1e-12));
  const auto f = [](double h) { return 3 + 0.5 * h * h; };
  const Extrapolation three = extrapolate(f(0.4), f(0.2), f(0.1)),
                      two = extrapolate_order(f(0.2), f(0.1), 2.0);
  CHECK(three.order == near(2, 1e-12));
  CHECK(three.limit == near(3, 1e-12));
  CHECK(two.limit == near(3, 1e-12));
  const auto g = [&](double h) { return f(h) - 7 * h * h * h * h; };
  CHECK(romberg(g(0.4), g(0.2), g(0.1)) == near(3, 1e-12));
  CHECK(two.mesh_error == near(0.005 / 3, 1e-12));
}

TEST_CASE("the plot of the studies holds every point, one curve per study") {
  lobe::validation::Findings findings("f");
  findings.study("a", {0.5, 0.25}, {0.125, 0.03125});
  findings.study("b", {1.0}, {0.75});
  const std::string script = study_script(findings.points());
  CHECK(script.find("$study0 << end\n1 0.125\n0.5 0.03125\nend\n$study1 << end\n1 0.75\nend\n") == 0);
  CHECK(script.find("$study1 with linespoints") != std::string::npos);
}
