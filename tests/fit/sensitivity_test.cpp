#include "lobe/fit/sensitivity.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/solve/static_solver.h"
#include "near.h"

using namespace lobe;
using lobe::test::near;

namespace {

struct Pulled {
  Scene scene;
  Resolved resolved;
};

// Two materials, a grasp at the free end, weight.
Pulled pulled_bar(const std::string& regions = R"([{"model": "nonlinear"}])",
                  const std::string& element = "tetrahedron", double nodal_pressure = 0) {
  const std::string moduli = R"("poisson_ratio": 0.4, "nodal_pressure": )" + std::to_string(nodal_pressure) +
                             R"(, "element": ")" + element + R"("})";
  Scene scene = parse_scene(
      R"({"mesh": "bar.vtu",
          "materials": [{"name": "soft", "young_modulus": 2e4, )" +
      moduli + R"(, {"name": "stiff", "where": {"box": {"min": [0.06, -1, -1], "max": [1, 1, 1]}},
                     "young_modulus": 8e4, )" +
      moduli + R"(], "regions": )" + regions + R"(,
          "boundary": [{"fix": true, "where": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}}],
          "gravity": [0, 0, -9.81],
          "tools": [{"type": "grasp", "where": {"plane": {"point": [0.1, 0, 0], "normal": [1, 0, 0], "within": 1e-6}},
                     "path": [[0, 0, 0, 0], [1, 0.004, 0, 0.01]]}],
          "time": {"duration": 1, "frame": 0.1}})");
  Resolved resolved = resolve(scene, box_mesh({0.1, 0.02, 0.02}, 10, 2, 2));
  return {std::move(scene), std::move(resolved)};
}

const Effect& effect(const Sensitivity& found, const std::string& name) {
  const auto at = std::find_if(found.effects.begin(), found.effects.end(),
                               [&](const Effect& e) { return e.of.starts_with(name); });
  REQUIRE_MESSAGE(at != found.effects.end(), name);
  return *at;
}

}  // namespace

TEST_CASE("the effect of a modulus is that of solutions with other moduli") {
  const Pulled body = pulled_bar();
  const std::vector<Sensitivity> found = sensitivities(body.scene, body.resolved);
  REQUIRE(found.size() == 2);
  CHECK(found[0].gesture == "weight");
  CHECK(found[0].force == 0);
  CHECK(found[1].force > 0);
  Scene stiffer = body.scene;
  stiffer.materials[0].lame_lambda *= 1.001;
  stiffer.materials[0].lame_mu *= 1.001;
  const Resolved other = resolve(stiffer, box_mesh({0.1, 0.02, 0.02}, 10, 2, 2));
  const std::vector<Sensitivity> there = sensitivities(stiffer, other);
  for (int i = 0; i < 2; ++i) {
    const Effect& by = effect(found[std::size_t(i)], "soft.young_modulus + 10 %");
    const double scale = std::log(1.1) / std::log(1.001);
    const double growth = there[std::size_t(i)].largest / found[std::size_t(i)].largest - 1;
    if (i == 0) CHECK(by.largest == near(scale * growth, 2e-3));
    if (i == 1) CHECK(by.force == near(scale * (there[1].force / found[1].force - 1), 2e-3));
  }
}

// All moduli and the density grow alike: the weight's displacement stays as it is.
TEST_CASE("effects of moduli and density on the sag of a body cancel") {
  const Pulled body = pulled_bar();
  const Sensitivity weight = sensitivities(body.scene, body.resolved)[0];
  double sum = 0;
  for (const char* name : {"soft.young_modulus", "stiff.young_modulus", "soft.density", "stiff.density"})
    sum += effect(weight, name).largest;
  CHECK(std::abs(sum) < 1e-6 * std::abs(effect(weight, "soft.density").largest));
  for (std::size_t i = 1; i < weight.effects.size(); ++i)
    CHECK(weight.effects[i - 1].displacement >= weight.effects[i].displacement);
}

TEST_CASE("the effects of tetrahedra add up to that of the stiffness of their material, in every element") {
  for (const char* element : {"tetrahedron", "edge-smoothed"})
    for (const double nodal_pressure : {0.0, 0.8}) {
      CAPTURE(element);
      CAPTURE(nodal_pressure);
      const Pulled body = pulled_bar(
          R"([{"model": "tensor-mass", "where": {"box": {"min": [-1, -1, -1], "max": [0.03, 1, 1]}}},
              {"model": "nonlinear"}])",
          element, nodal_pressure);
      const Setup& setup = body.resolved.setup;
      for (const Sensitivity& answer : sensitivities(body.scene, body.resolved)) {
        CAPTURE(answer.gesture);
        REQUIRE(Index(answer.of_tets.size()) == setup.mesh.tet_count());
        double all = 0;
        for (std::size_t material : {0, 1}) {
          double sum = 0;
          for (Index t = 0; t < setup.mesh.tet_count(); ++t)
            if (setup.material_of[std::size_t(t)] == material) sum += answer.of_tets[std::size_t(t)];
          const double share = sum / double(setup.mesh.tet_count());  // all have one volume
          all += share;
          const std::string name = body.scene.materials[material].name + ".young_modulus";
          if (answer.force > 0) CHECK(std::log(1.1) * share == near(effect(answer, name).force, 1e-4));
        }
        if (answer.force == 0) CHECK(all < -0.1);  // a stiffer body sags less
      }
    }
}

TEST_CASE("a held part that gives way and models of regions have effects") {
  const Pulled body =
      pulled_bar(R"([{"model": "tensor-mass", "where": {"box": {"min": [-1, -1, -1], "max": [0.03, 1, 1]}}},
                           {"model": "nonlinear"}])");
  const Sensitivity weight = sensitivities(body.scene, body.resolved)[0];
  CHECK(effect(weight, "/boundary/0 held by nine tenths").largest > 0.001);
  CHECK(effect(weight, "tensor-mass regions as non-linear").displacement > 1e-5);
  CHECK(effect(weight, "non-linear regions as linear").displacement > 1e-4);
  CHECK(sensitivity_table({weight}).find("soft.young_modulus + 10 %") != std::string::npos);
}
