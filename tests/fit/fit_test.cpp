#include "lobe/fit/fit.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "near.h"

using namespace lobe;
using lobe::test::near;

namespace {

// A bar that is held at one end; entry 1 of its "boundary" loads or moves the other one.
Resolved bar(const std::string& material, const std::string& load) {
  const Scene scene = parse_scene(
      R"({"mesh": "bar.vtu", "materials": [{"name": "gel", )" + material + R"(}],
          "regions": [{"model": "nonlinear"}],
          "boundary": [{"fix": true, "where": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}},
                       {)" +
      load + R"(, "where": {"plane": {"point": [0.08, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}}],
          "time": {"duration": 1, "frame": 0.1}})");
  return resolve(scene, box_mesh({0.08, 0.03, 0.02}, 8, 3, 2));
}

const std::string stretched = R"("displacement": [0.008, 0, 0])", hanging = R"("traction": [0, 0, -150])",
                  true_moduli = R"("young_modulus": 3e4, "poisson_ratio": 0.35)",
                  guess = R"("young_modulus": 8e4, "poisson_ratio": 0.2)";

std::vector<Parameter> parameters_of(const std::string& material, const std::vector<std::string>& names) {
  Scene scene;
  scene.materials =
      parse_scene(R"({"mesh": "m.vtu", "materials": [{"name": "gel", )" + material +
                  R"(}], "regions": [{"model": "nonlinear"}], "time": {"duration": 1, "frame": 0.1}})")
          .materials;
  return find_parameters(scene, names);
}

const char* const tip = "displacement,0.08 0.015 0.02,z,0,m,\n";
const char* const side = "displacement,0.04 0.03 0.01,y,0,m,\ndisplacement,0.04 0.015 0.02,z,0,m,\n";
const char* const grip = "force,1,x,0,N,\n";

std::vector<Measurement> places(const std::string& lines) {
  return parse_measurements("quantity,at,component,value,unit,sigma\n" + lines, "data.csv");
}

// What a body with the true moduli would show at these places, with a relative noise of normal distribution.
FitCase measured_on(const std::string& load, const std::string& lines, const std::vector<std::string>& names,
                    double noise = 0, unsigned seed = 1) {
  const Resolved truth = bar(true_moduli, load);
  const StaticResult found = solve_static(truth.setup);
  REQUIRE_MESSAGE(found.converged, found.reason);
  std::vector<Measurement> measured = places(lines);
  const Eigen::VectorXd values =
      Observations(truth, measured, "data.csv").values(found.u, found.reactions, Eigen::VectorXd());
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  for (std::size_t i = 0; i < measured.size(); ++i)
    measured[i].value = values[Eigen::Index(i)] * (1 + (noise > 0 ? normal(random) : 0));
  const Resolved start = bar(guess, load);
  return {start.setup, Observations(start, measured, "data.csv"), parameters_of(guess, names)};
}

std::string repeated(const std::string& lines, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += lines;
  return all;
}

}  // namespace

TEST_CASE("one modulus is found again from what a body shows, to rounding without noise") {
  const FitResult found = fit({measured_on(hanging, tip, {"young_modulus"})});
  REQUIRE_MESSAGE(found.converged, found.reason);
  // Poisson's ratio of the guess is another one, so that the modulus is, too, but the measurement is met.
  CHECK(found.misfit < 1e-8);
  const FitResult both =
      fit({measured_on(stretched, repeated(side, 1) + grip, {"young_modulus", "poisson_ratio"})});
  REQUIRE_MESSAGE(both.converged, both.reason);
  CHECK(both.parameters[0].value == near(3e4, 1e-5));
  CHECK(both.parameters[1].value == near(0.35, 1e-5));
  CHECK(both.parameters[0].start == near(8e4, 1e-12));
}

TEST_CASE("with 2 % of noise, E is found within 2 %, E and nu within 5 %, and intervals hold what is true") {
  int inside = 0, intervals = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const FitResult found = fit({measured_on(stretched, repeated(std::string(side) + grip, 10),
                                             {"gel.young_modulus", "gel.poisson_ratio"}, 0.02, seed)});
    REQUIRE_MESSAGE(found.converged, found.reason);
    const FittedParameter &E = found.parameters[0], &nu = found.parameters[1];
    CHECK(std::abs(E.value / 3e4 - 1) < 0.02);
    CHECK(std::abs(nu.value / 0.35 - 1) < 0.05);
    inside += E.low < 3e4 && 3e4 < E.high;
    inside += nu.low < 0.35 && 0.35 < nu.high;
    intervals += 2;
    CHECK(E.high / E.low < 1.1);
    CHECK(found.misfit == near(0.02, 0.5));
    CHECK(found.notes.empty());
  }
  CHECK(inside >= intervals - 6);  // 95 % of 40 are 38; fewer than 34 have a probability of 0.3 %
}

TEST_CASE("several loads are fitted together, and each has its own scene") {
  const FitResult found = fit({measured_on(stretched, grip, {"young_modulus", "poisson_ratio"}),
                               measured_on(stretched, side, {"young_modulus", "poisson_ratio"}),
                               measured_on(hanging, tip, {"young_modulus", "poisson_ratio"})});
  REQUIRE_MESSAGE(found.converged, found.reason);
  CHECK(found.parameters[0].value == near(3e4, 1e-4));
  CHECK(found.parameters[1].value == near(0.35, 1e-4));
  CHECK(found.values.size() == 3);
}

TEST_CASE("a frequency tells the modulus: it goes with its root") {
  const Resolved start = bar(true_moduli, R"("traction": [0, 0, 0])");
  std::vector<Measurement> measured = places("frequency,1,,1,Hz,\n");
  const std::vector<Parameter> E = parameters_of(true_moduli, {"young_modulus"});
  const FitResult first = fit({{start.setup, Observations(start, measured, "f"), E}});
  REQUIRE_MESSAGE(first.converged, first.reason);
  measured[0].value = 2;
  const FitResult second = fit({{start.setup, Observations(start, measured, "f"), E}});
  REQUIRE_MESSAGE(second.converged, second.reason);
  CHECK(second.parameters[0].value / first.parameters[0].value == near(4, 1e-5));
}

TEST_CASE("what the measurements do not tell is said") {
  // The shape of a body that is moved does not depend on its modulus.
  const FitResult none = fit({measured_on(stretched, repeated(side, 3), {"young_modulus"}, 0.02)});
  REQUIRE(none.notes.size() == 1);
  CHECK(none.notes[0].find("do not depend on gel.young_modulus") != std::string::npos);
  CHECK(!none.parameters[0].is_identifiable);
  CHECK(std::isinf(none.parameters[0].high));
  // Frequencies tell the ratio of modulus and density.
  const Resolved start = bar(true_moduli, R"("traction": [0, 0, 0])");
  const FitResult ratio =
      fit({{start.setup, Observations(start, places("frequency,1,,3,Hz,\nfrequency,2,,4,Hz,\n"), "data.csv"),
            parameters_of(true_moduli, {"young_modulus", "density"})}});
  REQUIRE(ratio.notes.size() >= 1);
  CHECK(ratio.notes[0].find("gel.young_modulus and gel.density") != std::string::npos);
}

TEST_CASE("fits that cannot be are refused") {
  CHECK_THROWS_WITH_AS(fit({measured_on(stretched, grip, {"young_modulus", "poisson_ratio"})}),
                       doctest::Contains("2 parameters cannot be found from 1 measurement"), InputError);
  CHECK_THROWS_WITH_AS(
      parameters_of(guess, {"gel.yung", "gel.young_modulus", "young_modulus"}),
      doctest::Contains("it has gel.young_modulus, gel.poisson_ratio, gel.density, gel.stiffness"),
      InputError);
  CHECK_THROWS_WITH_AS(parameters_of(guess, {"gel.young_modulus", "young_modulus"}),
                       doctest::Contains("is asked for twice"), InputError);
  CHECK_THROWS_WITH_AS(parameters_of(guess, {"stiffness", "young_modulus"}),
                       doctest::Contains("does not go with gel.young_modulus"), InputError);
  const Resolved start = bar(guess, stretched);
  CHECK_THROWS_WITH_AS(Observations(start, places("displacement,0.2 0 0,x,1,m,\n"), "data.csv"),
                       doctest::Contains("outside of the body"), InputError);
  CHECK_THROWS_WITH_AS(Observations(start, places("force,7,x,1,N,\n"), "data.csv"),
                       doctest::Contains("/boundary/7 holds or moves nothing"), InputError);
}

TEST_CASE("parameters are those of the law, and a value that is set is read again") {
  const std::string law =
      R"("young_modulus": 3e4, "poisson_ratio": 0.4, "law": "yeoh", "yeoh_c2": 100, "yeoh_c3": 5)";
  std::vector<Parameter> yeoh =
      parameters_of(law, {"young_modulus", "poisson_ratio", "density", "yeoh_c2", "yeoh_c3"});
  yeoh.push_back(parameters_of(law, {"stiffness"})[0]);
  for (const Parameter& parameter : yeoh) {
    Elastic changed = parameter.at_start;
    const double value = parameter.scale == ParameterScale::below_half ? 0.37 : 7;
    set(parameter, value, changed);
    CHECK(value_of(parameter, changed) == near(value, 1e-12));
    CHECK(parameter.from_scale(parameter.on_scale(value)) == near(value, 1e-12));
  }
  CHECK_THROWS_AS(parameters_of(guess, {"yeoh_c2"}), InputError);
}
