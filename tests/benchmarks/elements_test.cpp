// `lobe bench elements`.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "benchmarks/bench_results.h"
#include "benchmarks/element_frequency.h"
#include "benchmarks/validation/bodies.h"
#include "lobe/mesh/generators.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("lobe bench elements tells how much better edge-smoothed tetrahedra are, and what they cost") {
  const BenchResults results("elements", "--quick");
  std::map<std::string, std::map<std::string, double>> errors;  // by body and gesture, and element
  for (const Record& row : results.rows("elements")) {
    errors[row.at("body") + ", " + row.at("gesture")][row.at("element")] = std::abs(number(row, "error"));
    const bool is_plain = row.at("element") == "plain";
    const bool is_hybrid = row.at("element").find("hybrid") != std::string::npos;
    const double step = number(row, "step_ratio");
    CHECK((is_plain ? step == 1 : step > (is_hybrid ? 0.9 : 1)));
    CHECK((is_plain ? number(row, "time_ratio") == 1 : number(row, "time_ratio") > 0));
  }
  REQUIRE(errors.size() == 4);
  for (const auto& [gesture, of] : errors) {
    INFO(gesture);
    REQUIRE(of.size() == 6);
    CHECK(of.at("edge-smoothed") < of.at("plain") / 3);
    CHECK(of.at("edge-smoothed hybrid") < of.at("plain hybrid") / 2);
  }
  CHECK(errors["beam of ν = 0.49, bent"]["edge-smoothed with nodal_pressure"] < 0.06);
}

TEST_CASE("the lowest frequency of a slender beam is that of theory") {
  constexpr double length = 1, side = 0.05, young = 2e5, density = 1000;
  Setup setup = validation::body_of(box_mesh({length, side, side}, 20, 2, 2), {0, young / 2, density},
                                    RegionModel::nonlinear);
  validation::prescribe(setup,
                        validation::vertices_where(setup.mesh, [](const Vec3d& X) { return X.x() == 0; }),
                        [](const Vec3d&) { return Vec3d::Zero(); });
  // Euler-Bernoulli, clamped and free: (βL)² √(EI/ρAL⁴) with cosh βL cos βL = −1.
  const double exact =
      1.8751040687 * 1.8751040687 * side / std::sqrt(12.0) * std::sqrt(young / density) / (length * length);
  CHECK(bench::lowest_quadratic_frequency(setup) == near(exact, 0.01));
  CHECK(bench::lowest_frequency(setup) > exact);  // plain tetrahedra are too stiff
  setup.materials[0].element = ElementType::edge_smoothed;
  CHECK(bench::lowest_frequency(setup) == near(exact, 0.15));
}
