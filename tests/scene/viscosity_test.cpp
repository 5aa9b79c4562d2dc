// Viscosity in a scene: read, written, described, and what is wrong with it, on a bar of 0.4 × 0.1 × 0.1 m.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "lobe/sim/world.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

json viscous_scene(const std::string& series, const std::string& patch = "{}") {
  json scene = json::parse(R"({"mesh": "bar.vtu", "materials": [{"young_modulus": 3e3, "poisson_ratio": 0.4}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}]})");
  scene["materials"][0]["viscosity"] = json::parse(series);
  scene.merge_patch(json::parse(patch));
  return scene;
}

Resolved resolved(const json& scene) {
  return resolve(parse_scene(scene.dump()), box_mesh(Vec3d(0.4, 0.1, 0.1), 4, 1, 1));
}

std::string viscous_fault(const json& scene) {
  try {
    resolved(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void check_has(const std::string& text, const std::string& part) {
  CAPTURE(text);
  CHECK(text.find(part) != std::string::npos);
}

const std::string two_terms = R"([{"shear": 0.3, "bulk": 0.1, "time": 0.05}, {"shear": 0.2, "time": 1.5}])";

struct HandForces {
  double highest, last;  // [N]
};

// On the hand that pulls at a liver and stays there.
HandForces hand_forces(const Scene& scene) {
  World<float> world(resolve(scene, read_scene_mesh(scene).mesh).setup);
  HandForces forces{0, 0};
  while (world.time() < 2.19) {
    REQUIRE(world.advance(scene.time.frame).ok);
    if (world.tools().lists().grasps.empty()) continue;
    forces.last = world.tools().lists().grasps.front().force.norm();
    forces.highest = std::max(forces.highest, forces.last);
  }
  return forces;
}

}  // namespace

TEST_CASE("a series of a scene is read, written as the same one, resolved and told") {
  const Scene scene = parse_scene(viscous_scene(two_terms).dump());
  const std::string once = to_json(scene);
  CHECK(to_json(parse_scene(once)) == once);
  const Resolved made = resolved(viscous_scene(two_terms));
  const auto series = made.setup.materials.at(0).prony_series();
  REQUIRE(series.size() == 2);
  CHECK(series[0] == PronyTerm{0.3, 0.1, 0.05});
  CHECK(series[1] == PronyTerm{0.2, 0, 1.5});
  check_has(describe(scene, made),
            "relaxing in 0.05, 1.5 s, in shear at once 2 times as stiff, in bulk at once 1.1");
  json elastic = viscous_scene(two_terms);
  elastic["materials"][0].erase("viscosity");
  CHECK(to_json(parse_scene(elastic.dump())).find("viscosity") == std::string::npos);
}

TEST_CASE("what is wrong with a series is named where it stands") {
  const auto fault = [](const std::string& series) { return viscous_fault(viscous_scene(series)); };
  CHECK(fault(two_terms).empty());
  check_has(fault(R"([{"shear": 0.6, "time": 1}, {"shear": 0.4, "time": 2}])"),
            "/materials/0/viscosity: the shares of shear");
  check_has(fault(R"([{"bulk": 0.6, "time": 1}, {"bulk": 0.5, "time": 2}])"), "the shares of bulk");
  check_has(fault(R"([{"shear": 0, "time": 1}])"), "needs a share of shear or of bulk");
  check_has(fault(R"([{"shear": 0.6, "time": 0}])"), "/materials/0/viscosity/0/time");
  check_has(fault(R"([{"shear": -0.6, "time": 1}])"), "/materials/0/viscosity/0/shear");
  check_has(fault(R"([{"shear": 0.6}])"), "/materials/0/viscosity/0");
  check_has(fault(R"([{"time": 2}])"), "/materials/0/viscosity/0: needs \"shear\" or \"bulk\"");
  check_has(fault(R"([{"shear": 0.6, "tau": 2}])"), "/materials/0/viscosity/0");
  check_has(fault("[]"), "/materials/0/viscosity");
  check_has(fault(R"([{"shear": 0.1, "time": 1}, {"shear": 0.1, "time": 2}, {"shear": 0.1, "time": 3},
                     {"shear": 0.1, "time": 4}])"),
            "/materials/0/viscosity");
  check_has(viscous_fault(
                viscous_scene(R"([{"bulk": 0.6, "time": 1}])", R"({"regions": [{"model": "tensor-mass"}]})")),
            "/materials/0/viscosity: \"viscosity\" does not go with \"model\": \"tensor-mass\"");
}

TEST_CASE(
    "nodal pressure that is not named is left out where volume relaxes, and refused where it is named") {
  const auto pressure_of = [](const std::string& series, bool named) {
    json scene = viscous_scene(series);
    scene["materials"][0]["poisson_ratio"] = 0.48;
    if (named) scene["materials"][0]["nodal_pressure"] = true;
    return resolved(scene).setup.materials.at(0).nodal_pressure;
  };
  CHECK(pressure_of(R"([{"shear": 0.6, "time": 1}])", false) == 1);
  CHECK(pressure_of(two_terms, false) == 0);
  CHECK(pressure_of(R"([{"shear": 0.6, "time": 1}])", true) == 1);
  CHECK_THROWS_WITH_AS(pressure_of(two_terms, true), doctest::Contains("nodal_pressure"), InputError);
}

TEST_CASE("the shipped liver pulls hardest at first, and in the end as one without viscosity") {
  Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "liver_relaxing.json");
  const HandForces viscous = hand_forces(scene);
  scene.materials[0].viscosity = {};
  const HandForces elastic = hand_forces(scene);
  MESSAGE("viscous: ", viscous.highest, " N, then ", viscous.last, " N; elastic: ", elastic.highest,
          " N, then ", elastic.last, " N");
  CHECK(viscous.highest > 1.2 * elastic.highest);
  CHECK(viscous.last == near(elastic.last, 0.03));
}
