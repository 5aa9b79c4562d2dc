#include "lobe/scene/describe.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

// A bar of 0.4 × 0.1 × 0.1 m: 4e-3 m³, 4 kg.
const Scene scene = parse_scene(R"({
  "name": "bar",
  "mesh": "bar.vtu",
  "materials": [{"name": "soft", "young_modulus": 1e4, "poisson_ratio": 0.25}],
  "regions": [{"model": "tensor-mass", "where": {"tetrahedra": [0, 1, 2]}}],
  "boundary": [
    {"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}},
    {"displacement": [0.01, 0, 0], "where": {"vertices": [19]}},
    {"traction": [0, 0, -100], "where": {"plane": {"point": [0, 0, 0.1], "normal": [0, 0, 1], "side": "above"}}},
    {"force": [0, 0, -2], "where": {"nearest": {"point": [0.4, 0, 0], "count": 3}}}],
  "gravity": [0, 0, -10],
  "tools": [
    {"name": "g", "type": "grasp", "where": {"vertices": [4]}, "path": [[0, 0, 0, 0], [1, 0, 0, 0.1]]},
    {"type": "cautery", "radius": 0.01, "path": [[0.25, 0.2, 0, 0]]}],
  "time": {"duration": 2, "frame": 0.02, "precision": "double"},
  "output": {"every": 0.1, "pictures": [1]}
})");
const Resolved resolved = resolve(scene, box_mesh({0.4, 0.1, 0.1}, 4, 1, 1));

}  // namespace

TEST_CASE("the description in JSON holds the exact totals") {
  const json d = json::parse(describe_json(scene, resolved));
  CHECK(d["mesh"]["vertices"] == 20);
  CHECK(d["mesh"]["tetrahedra"] == 24);
  CHECK(d["mesh"]["labels"] == json{{"0", 24}});
  CHECK(d["mesh"]["volume_m3"].get<double>() == near(4e-3, 1e-12));
  CHECK(d["materials"][0]["young_modulus_Pa"].get<double>() == near(1e4, 1e-12));
  CHECK(d["materials"][0]["poisson_ratio"].get<double>() == near(0.25, 1e-12));
  // λ = μ = 4000 Pa, c = √(12000/1000)
  CHECK(d["materials"][0]["wave_speed_m_s"].get<double>() == near(std::sqrt(12.0), 1e-12));
  CHECK(d["materials"][0]["expected_sag_m"].get<double>() == near(0.18, 1e-12));
  CHECK(d["materials"][0]["tetrahedra"] == 24);
  CHECK(d["regions"] ==
        json{{"tensor-mass", 3}, {"precomputed", 0}, {"nonlinear", 21}, {"reduced", 0}, {"corotational", 0}});
  CHECK(d["fixed_vertices"] == 4);
  CHECK(d["moved_vertices"] == 1);
  CHECK(d["loads"]["force_N"][2].get<double>() == near(-2, 1e-12));
  CHECK(d["loads"]["loaded_area_m2"].get<double>() == near(0.04, 1e-12));
  CHECK(d["loads"]["traction_force_N"][2].get<double>() == near(-4, 1e-12));
  CHECK(d["loads"]["mass_kg"].get<double>() == near(4, 1e-12));
  CHECK(d["loads"]["weight_N"][2].get<double>() == near(-40, 1e-12));
  CHECK(d["tools"][0]["vertices"] == 1);
  CHECK(d["tools"][1]["radius_m"] == 0.01);
  CHECK(d["vtu_frames"] == 21);
  CHECK(d["pictures"] == 1);
  CHECK(d["warnings"].empty());
}

TEST_CASE("nodal pressure is described where it is asked for") {
  Scene averaged = scene;
  averaged.materials[0].nodal_pressure = 0.5;
  const Resolved result = resolve(averaged, box_mesh({0.4, 0.1, 0.1}, 4, 1, 1));
  CHECK(json::parse(describe_json(averaged, result))["materials"][0]["nodal_pressure"] == 0.5);
  CHECK(describe(averaged, result).find("0.18 m, nodal pressure 0.5, edge-smoothed\n") != std::string::npos);
}

TEST_CASE("the description in words says what will be run") {
  Resolved doubtful = resolved;
  doubtful.warnings = {"/tools/0: doubtful"};
  CHECK(describe(scene, doubtful) ==
        "scene      bar\n"
        "mesh       bar.vtu: 20 vertices, 24 tetrahedra, 0.004 m³, [0, 0, 0] to [0.4, 0.1, 0.1] m\n"
        "material   soft: 24 tetrahedra, E 1e+04 Pa, nu 0.25, density 1000 kg/m³, waves 3.464 m/s, sag under "
        "gravity about 0.18 m, edge-smoothed\n"
        "volume     penalty 0 Pa\n"
        "regions    tensor-mass 3, precomputed 0, nonlinear 21, reduced 0, corotational 0 tetrahedra\n"
        "held       4 vertices fixed, 1 moved\n"
        "loads      force [0, 0, -2] N, traction [0, 0, -4] N on 0.04 m²\n"
        "weight     40 N, mass 4 kg\n"
        "tool       g: grasp, 0 to 1 s, 1 vertices\n"
        "tool       cautery: cautery, 0.25 to 0.25 s, radius 0.01 m\n"
        "run        2 s in frames of 0.02 s, explicit, double precision\n"
        "output     21 VTU frames, 1 pictures\n"
        "warning    /tools/0: doubtful\n");
}

TEST_CASE("the pace is told where one part is much stiffer than another, as an estimate") {
  Scene stiff = scene;
  stiff.materials.push_back(stiff.materials[0]);
  stiff.materials[1].name = "wall";
  Resolved two = resolve(scene, box_mesh({0.8, 0.1, 0.1}, 8, 1, 1));
  CHECK_FALSE(json::parse(describe_json(scene, two)).contains("pace"));
  two.setup.materials.push_back(two.setup.materials[0]);
  two.setup.materials[1].lambda *= 4096;
  two.setup.materials[1].mu *= 4096;
  for (Index t = 42; t < 48; ++t) two.setup.material_of[std::size_t(t)] = 1;  // the last cell
  const json pace = json::parse(describe_json(stiff, two))["pace"];
  CHECK(pace["materials"][0]["name"] == "soft");
  CHECK(pace["materials"][0]["up_to_times"] >= 4);
  CHECK(pace["materials"][1]["name"] == "wall");
  CHECK(pace["materials"][1]["up_to_times"] == 1);
  CHECK(pace["evaluations"].get<double>() < 0.7);
  CHECK_FALSE(pace["own_steps"].get<bool>());
  const std::string times = pace["materials"][0]["up_to_times"].dump();
  CHECK(describe(stiff, two).find("soft could take up to " + times + " times as long ones") !=
        std::string::npos);
  stiff.time.own_steps = true;
  CHECK(describe(stiff, two).find("soft takes up to " + times + " times as long ones") != std::string::npos);
  CHECK(describe(stiff, two).find("explicit, double precision, own steps") != std::string::npos);
  Scene alike = scene;
  alike.time.own_steps = true;
  CHECK(describe(alike, resolved).find("pace       own steps would spare less than a fifth of the work") !=
        std::string::npos);
  Scene later = stiff;
  later.auto_regions.emplace();
  CHECK_FALSE(json::parse(describe_json(later, two)).contains("pace"));
}
