// Fits to a scene in motion: relaxation, swings, attachments.
#include "lobe/fit/motion.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "lobe/error.h"
#include "lobe/fit/fit.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/held_forces.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/write_scene.h"
#include "near.h"

using namespace lobe;
using lobe::test::near;
using nlohmann::json;

namespace {

constexpr double frame = 0.02;  // [s]

json end_of_bar(double x) {
  return {{"plane", {{"point", {x, 0, 0}}, {"normal", {1, 0, 0}}, {"within", 1e-6}}}};
}

// A bar that is held at x = 0, and what happens to its other end.
json bar_with(const json& material, const json& patch) {
  json scene = {{"mesh", "bar.vtu"},
                {"materials", {{{"name", "gel"}, {"element", "edge-smoothed"}}}},
                {"regions", {{{"model", "nonlinear"}}}},
                {"boundary", {{{"fix", true}, {"where", end_of_bar(0)}}}},
                {"time", {{"duration", 1}, {"frame", frame}, {"damping", 40}}}};
  scene["materials"][0].merge_patch(material);
  for (const json& entry : patch.value("boundary", json::array())) scene["boundary"].push_back(entry);
  json rest = patch;
  rest.erase("boundary");
  scene.merge_patch(rest);
  return scene;
}

Resolved resolved_bar(const json& scene) {
  return resolve(parse_scene(scene.dump()), box_mesh({0.08, 0.02, 0.02}, 4, 1, 1));
}

const json stretched_bar = {{"boundary", {{{"displacement", {0.004, 0, 0}}, {"where", end_of_bar(0.08)}}}},
                            {"time", {{"ramp", 0.02}}}};
const json pulled_aside = {{"boundary", {{{"force", {0, 0, -0.003}}, {"where", end_of_bar(0.08)}}}},
                           {"time", {{"damping", 4}}}};

json relaxing(double E, double shear, double time) {
  return {{"young_modulus", E},
          {"poisson_ratio", 0.4},
          {"viscosity", {{{"shear", shear}, {"bulk", 0.2}, {"time", time}}}}};
}

std::vector<Measurement> table_of(const std::string& place, int count, double every) {
  std::string text = "quantity,at,component,value,unit,time\n";
  for (int i = 1; i <= count; ++i) text += place + "," + std::to_string(i * every) + "\n";
  return parse_measurements(text, "data.csv");
}
const char* const grip_force = "force,1,x,0,N";
const char* const tip_sag = "displacement,0.08 0.01 0.01,z,0,m";

Eigen::VectorXd played(const json& scene, const std::vector<Measurement>& places) {
  const Resolved resolved = resolved_bar(scene);
  std::string trouble;
  const auto found =
      values_in_motion(resolved.setup, Observations(resolved, places, "data.csv"), frame, trouble);
  REQUIRE_MESSAGE(found, trouble);
  return *found;
}

// What the true scene shows with a relative noise, to be fitted by the other one.
FitCase shown_by(const json& truth, const json& start, std::vector<Measurement> places,
                 const std::vector<std::string>& names, double noise = 0, unsigned seed = 1) {
  const Eigen::VectorXd values = played(truth, places);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i].value = values[Eigen::Index(i)] * (1 + noise * normal(random));
  const Resolved resolved = resolved_bar(start);
  return {resolved.setup, Observations(resolved, std::move(places), "data.csv"),
          find_parameters(parse_scene(start.dump()), names), frame};
}

}  // namespace

TEST_CASE("values in motion are those of a world that is played in the frames of the scene") {
  const json scene = bar_with(relaxing(3e4, 0.3, 0.1), stretched_bar);
  const Resolved resolved = resolved_bar(scene);
  std::vector<Measurement> places = table_of(grip_force, 3, 2 * frame),
                           points = table_of(tip_sag, 3, 2 * frame);
  places.insert(places.end(), points.begin(), points.end());
  const Eigen::VectorXd found = played(scene, places);
  World<double> world(resolved.setup);
  const Index end = resolved.held[1].vertices[0];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 2; ++k) world.advance(frame);
    const Vec3d force = held_forces(resolved.held, world.elements(), reactions_of(world))[1];
    CHECK(force.x() > 0.1);
    CHECK(found[i] == near(force.x(), 1e-9));
    CHECK(world.state().u(0, end) == near(0.004, 1e-9));
  }
  // Frames also end at measured times between.
  CHECK(played(scene, table_of(grip_force, 20, 0.3 * frame))[19] == near(found[2], 0.05));
}

TEST_CASE("a body whose motion has died away gives the modulus of its equilibrium") {
  const auto damped = [](double E) {
    json scene = bar_with({{"young_modulus", E}, {"poisson_ratio", 0.4}}, pulled_aside);
    scene["time"]["damping"] = 40;
    return scene;
  };
  const Resolved truth = resolved_bar(damped(3e4)), start = resolved_bar(damped(5e4));
  const StaticResult equilibrium = solve_static(truth.setup);
  REQUIRE(equilibrium.converged);
  std::vector<Measurement> places = table_of(tip_sag, 1, 3.0);
  places[0].value = Observations(truth, places, "data.csv")
                        .values(equilibrium.u, equilibrium.reactions, Eigen::VectorXd())[0];
  const FitResult found = fit({{start.setup, Observations(start, places, "data.csv"),
                                find_parameters(parse_scene(damped(5e4).dump()), {"young_modulus"}), frame}});
  REQUIRE_MESSAGE(found.converged, found.reason);
  CHECK(found.parameters[0].value == near(3e4, 2e-3));
}

TEST_CASE("a modulus and its relaxation are found again with 2 % of noise, and intervals hold what is true") {
  const json truth = bar_with(relaxing(3e4, 0.4, 0.15), stretched_bar),
             start = bar_with(relaxing(6e4, 0.2, 0.4), stretched_bar);
  const std::vector<double> exact{3e4, 0.4, 0.15};
  int inside = 0;
  constexpr int seeds = 10;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const FitResult both =
        fit({shown_by(truth, bar_with(relaxing(6e4, 0.2, 0.15), stretched_bar),
                      table_of(grip_force, 50, frame), {"young_modulus", "prony_shear_1"}, 0.02, seed)});
    REQUIRE_MESSAGE(both.converged, both.reason);
    for (std::size_t j = 0; j < 2; ++j) {
      const FittedParameter& p = both.parameters[j];
      CAPTURE(p.name);
      CHECK(p.value == near(exact[j], j == 0 ? 0.02 : 0.05));
      CHECK(p.is_identifiable);
      inside += p.low < exact[j] && exact[j] < p.high;
    }
    CHECK(both.notes.empty());
    CHECK(both.misfit == near(0.02, 0.35));
  }
  CHECK(inside >= 2 * seeds - 4);  // 95 % of 20 are 19; fewer than 16 have a probability of 0.3 %
  const FitResult all = fit({shown_by(truth, start, table_of(grip_force, 50, frame),
                                      {"young_modulus", "prony_shear_1", "prony_time_1"})});
  REQUIRE_MESSAGE(all.converged, all.reason);
  for (std::size_t j = 0; j < 3; ++j) CHECK(all.parameters[j].value == near(exact[j], 5e-3));
}

TEST_CASE("a swing tells the modulus and the damping") {
  const auto swinging = [](double E, double damping) {
    json scene = bar_with({{"young_modulus", E}, {"poisson_ratio", 0.4}}, pulled_aside);
    scene["time"]["damping"] = damping;
    return scene;
  };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const FitResult found =
        fit({shown_by(swinging(3e4, 4), swinging(3.5e4, 2), table_of(tip_sag, 100, frame / 2),
                      {"young_modulus", "damping"}, 0.02, seed)});
    REQUIRE_MESSAGE(found.converged, found.reason);
    CHECK(found.parameters[0].value == near(3e4, 0.02));
    CHECK(found.parameters[1].value == near(4, 0.05));
  }
}

// A bar that a ligament holds up, too: its fixed end tells how they share the load.
TEST_CASE("the stiffness of a ligament is found beside the modulus, and its strength stays") {
  const auto tied = [](double E, double stiffness) {
    json scene = bar_with({{"young_modulus", E}, {"poisson_ratio", 0.4}}, pulled_aside);
    scene["time"]["damping"] = 40;
    scene["attachments"] = {{{"name", "cord"},
                             {"ligament",
                              {{"from", {0.08, 0.01, 0.02}},
                               {"to_world", {0.08, 0.01, 0.06}},
                               {"stiffness", stiffness},
                               {"strength", 2}}}}};
    return scene;
  };
  const std::vector<std::string> names{"young_modulus", "attachments.cord.stiffness"};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::vector<Measurement> places = table_of(tip_sag, 20, 2 * frame),
                             more = table_of("force,0,z,0,N", 20, 2 * frame);
    places.insert(places.end(), more.begin(), more.end());
    const FitResult found = fit({shown_by(tied(3e4, 3), tied(4e4, 1.5), places, names, 0.02, seed)});
    REQUIRE_MESSAGE(found.converged, found.reason);
    CHECK(found.parameters[0].value == near(3e4, 0.05));
    CHECK(found.parameters[1].value == near(3, 0.05));
    CHECK(found.notes.empty());
  }
  Scene scene = parse_scene(tied(3e4, 3).dump());
  Resolved resolved = resolved_bar(tied(3e4, 3));
  const Parameter cord = find_parameters(scene, names)[1];
  set(cord, 12, resolved.setup);
  set(cord, 12, scene);
  const AttachmentSetup stiffer = resolved.setup.attachments[0],
                        again = resolved_bar(json::parse(to_json(scene))).setup.attachments[0];
  CHECK(stiffer.strands[0].stiffness == near(12, 1e-12));
  CHECK(stiffer.strands[0].stiffness * stiffer.holds_until == near(2, 1e-12));
  CHECK(again.holds_until == near(stiffer.holds_until, 1e-12));
}

TEST_CASE(
    "parameters of motion are set in the scene and in what it is resolved to, and a bed keeps its energy") {
  json document = bar_with(relaxing(3e4, 0.3, 0.1), stretched_bar);
  document["attachments"] = {{{"name", "bed"},
                              {"bed",
                               {{"from", {{"box", {{"min", {-1, -1, 0.02}}, {"max", {1, 1, 1}}}}}},
                                {"to_world", true},
                                {"stiffness", 1e4},
                                {"fracture_energy", 10}}}}};
  Scene scene = parse_scene(document.dump());
  Resolved resolved = resolved_bar(document);
  const std::vector<std::string> names{"prony_shear_1", "gel.prony_bulk_1", "prony_time_1",
                                       "attachments.bed.stiffness", "damping"};
  const std::vector<double> values{0.25, 0.1, 0.7, 4e4, 3};
  const std::vector<Parameter> found = find_parameters(scene, names);
  for (std::size_t j = 0; j < found.size(); ++j) {
    CHECK(found[j].in_motion);
    CHECK(found[j].from_scale(found[j].on_scale(values[j])) == near(values[j], 1e-12));
    set(found[j], values[j], resolved.setup);
    set(found[j], values[j], scene);
  }
  const Resolved again = resolved_bar(json::parse(to_json(scene)));
  CHECK(again.setup.materials[0].viscosity == resolved.setup.materials[0].viscosity);
  CHECK(again.setup.materials[0].viscosity[0] == PronyTerm{0.25, 0.1, 0.7});
  CHECK(again.setup.damping == 3);
  const AttachmentSetup &bed = resolved.setup.attachments[0], &read = again.setup.attachments[0];
  CHECK(bed.strands[0].stiffness == near(read.strands[0].stiffness, 1e-12));
  CHECK(bed.holds_until == near(read.holds_until, 1e-12));
}

TEST_CASE("what a motion does not tell is said") {
  // Long after the only term has relaxed, the slow modulus is left.
  json truth = bar_with(relaxing(3e4, 0.3, 0.01), stretched_bar);
  std::vector<Measurement> late;
  for (const Measurement& m : table_of(grip_force, 50, frame))
    if (*m.time > 0.5) late.push_back(m);
  const FitResult found = fit({shown_by(truth, truth, late, {"young_modulus", "prony_time_1"}, 0.02)});
  REQUIRE(found.notes.size() == 1);
  CHECK(found.notes[0].find("do not depend on gel.prony_time_1") != std::string::npos);
  CHECK(found.parameters[0].is_identifiable);
  CHECK(!found.parameters[1].is_identifiable);
  // An equilibrium knows no time.
  std::vector<Measurement> still =
      parse_measurements("quantity,at,component,value,unit\nforce,1,x,0.3,N\nforce,0,x,-0.3,N\n", "data.csv");
  const Resolved resolved = resolved_bar(truth);
  const FitResult slow = fit({{resolved.setup, Observations(resolved, still, "data.csv"),
                               find_parameters(parse_scene(truth.dump()), {"prony_shear_1"}), frame}});
  REQUIRE(slow.notes.size() == 1);
  CHECK(slow.notes[0].find("do not depend on gel.prony_shear_1") != std::string::npos);
}

TEST_CASE("a trial whose shares sum to all is refused") {
  json material = relaxing(3e4, 0.3, 0.05);
  material["viscosity"].push_back({{"shear", 0.6}, {"time", 0.5}});
  const json scene = bar_with(material, stretched_bar);
  Resolved resolved = resolved_bar(scene);
  set(find_parameters(parse_scene(scene.dump()), {"prony_shear_1"})[0], 0.5, resolved.setup);
  const Observations observed(resolved, table_of(grip_force, 1, frame), "data.csv");
  std::string trouble;
  CHECK_THROWS_WITH_AS(values_in_motion(resolved.setup, observed, frame, trouble),
                       doctest::Contains("must sum to less than 1"), InputError);
}

TEST_CASE("the force of a tool is its mean over the frame, and 0 after it has let go") {
  json document = bar_with({{"young_modulus", 3e4}, {"poisson_ratio", 0.4}}, json::object());
  document["tools"] = {{{"type", "grasp"},
                        {"name", "forceps"},
                        {"where", end_of_bar(0.08)},
                        {"release", true},
                        {"path", {{0, 0, 0, 0}, {0.1, 0.004, 0, 0}, {0.3, 0.004, 0, 0}}}}};
  const Eigen::VectorXd force = played(document, table_of("force,forceps,x,0,N", 20, frame));
  World<double> world(resolved_bar(document).setup);
  for (int i = 0; i < 12; ++i) world.advance(frame);
  CHECK(force[11] == near(placed_tools(world)[0].force.x(), 1e-9));
  CHECK(force[11] > 0.1);
  CHECK(force[19] == 0);
}

TEST_CASE("tables of motions that cannot be are refused") {
  const Resolved resolved =
      resolved_bar(bar_with({{"young_modulus", 3e4}, {"poisson_ratio", 0.4}}, stretched_bar));
  const auto read = [&](const std::string& lines) {
    Observations(resolved, parse_measurements("quantity,at,component,value,unit,time\n" + lines, "data.csv"),
                 "data.csv");
  };
  CHECK_THROWS_WITH_AS(read("force,hook,x,1,N,0.1\n"), doctest::Contains("\"hook\" is no tool of the scene"),
                       InputError);
  CHECK_THROWS_WITH_AS(read("force,0,x,1,N,-0.1\n"), doctest::Contains("time must be at least 0"),
                       InputError);
  CHECK_THROWS_WITH_AS(read("force,0,x,1,N,nan\n"), doctest::Contains("time \"nan\" is no finite number"),
                       InputError);
  CHECK_THROWS_WITH_AS(read("force,0,x,1,N,0.1\nforce,0,x,1,N,\n"),
                       doctest::Contains("time must be told for every number, or for none"), InputError);
  CHECK_THROWS_WITH_AS(read("frequency,1,,1,Hz,0.1\n"), doctest::Contains("a frequency has no time"),
                       InputError);
  json document = bar_with({{"young_modulus", 3e4}, {"poisson_ratio", 0.4}}, stretched_bar);
  document["tools"] = {
      {{"type", "grasp"}, {"name", "forceps"}, {"where", end_of_bar(0.08)}, {"path", {{0, 0, 0, 0}}}}};
  CHECK_THROWS_WITH_AS(
      Observations(resolved_bar(document),
                   parse_measurements("quantity,at,component,value,unit\nforce,forceps,x,1,N\n", "f"), "f"),
      doctest::Contains("a tool has a force in motion alone: give a time"), InputError);
}
