// Materials with fibres and of all laws in a scene, on a bar of 0.4 × 0.1 × 0.1 m.
#include <doctest/doctest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/refine.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

TetMesh bar() { return box_mesh(Vec3d(0.4, 0.1, 0.1), 4, 1, 1); }

json fibrous(const std::string& fibre, const std::string& patch = "{}") {
  json material = json::parse(R"({"young_modulus_along": 9e4, "young_modulus_across": 3e4,
    "poisson_ratio_along": 0.4, "poisson_ratio_across": 0.35, "shear_modulus_along": 2e4})");
  material["fibre"] = json::parse(fibre);
  material.update(json::parse(patch));
  return material;
}

// Two families of fibres at 30 degrees to the bar.
json artery() {
  return json::parse(R"({"lame_lambda": 4e4, "lame_mu": 1e4, "law": "holzapfel", "holzapfel_k1": 2e3,
    "holzapfel_k2": 0.8, "holzapfel_angle": 30, "holzapfel_plane": [0, 1, 0], "fibre": {"direction": [1, 0, 0]}})");
}

Scene scene_of(const json& material) {
  const json document = {
      {"mesh", "bar.vtu"},
      {"materials", json::array({material})},
      {"boundary",
       json::parse(R"([{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}])")}};
  return parse_scene(document.dump());
}

std::string fault_of(const json& material, const TetMesh& mesh = bar()) {
  try {
    resolve(scene_of(material), mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const Vec3d& X = Vec3d::UnitX();
bool all_along(const Mat3X<double>& fibres, const Vec3d& a) {
  return fibres.cols() > 0 && (fibres.colwise() - a).colwise().norm().maxCoeff() < 1e-12;
}

}  // namespace

TEST_CASE("a scene's fibres are unit vectors of the field that it names") {
  const auto fibres = [](const std::string& fibre, const TetMesh& mesh = bar()) {
    return resolve(scene_of(fibrous(fibre)), mesh).setup.mesh.fibres;
  };
  CHECK(all_along(fibres(R"({"direction": [3, 0, 0]})"), X));
  CHECK(all_along(fibres(R"({"harmonic": {"from": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}},
                                          "to": {"box": {"min": [0.4, -1, -1], "max": [1, 1, 1]}}}})"),
                  X));
  const Mat3X<double> around = fibres(R"({"axis": {"point": [0, 5, 0], "direction": [0, 1, 0]}})");
  const Vec3d arm = barycentre(bar(), 3);
  CHECK((around.col(3) - Vec3d(arm.z(), 0, -arm.x()).normalized()).norm() < 1e-12);
  TetMesh mesh = bar();
  mesh.fibres = (2 * X).replicate(1, mesh.tet_count());
  CHECK(all_along(fibres(R"({"array": "fibre"})", mesh), X));
}

TEST_CASE(
    "fibres in a mesh file survive writing and reading, and refinement; without a material none are kept") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "mesh.vtu";
  TetMesh mesh = bar();
  mesh.fibres = Vec3d(0.6, 0, 0.8).replicate(1, mesh.tet_count());
  write_vtu(file, mesh);
  CHECK(read_mesh(file).mesh.fibres == mesh.fibres);
  CHECK(all_along(refine(mesh).mesh.fibres, {0.6, 0, 0.8}));
  const Scene isotropic = scene_of({{"lame_lambda", 4e4}, {"lame_mu", 1e4}});
  CHECK(resolve(isotropic, mesh).setup.mesh.fibres.cols() == 0);
}

// Circles: what lies between given directions is found to second order in the edge, inside the body.
TEST_CASE("refinement interpolates a field of fibres") {
  const auto direction = [](const Vec3d& x) { return Vec3d(-x.y() - 1, x.x() + 1, 0).normalized(); };
  const auto worst = [&](int n) {
    TetMesh mesh = box_mesh(Vec3d::Ones(), n, n, n);
    mesh.fibres.resize(3, mesh.tet_count());
    for (Index t = 0; t < mesh.tet_count(); ++t) mesh.fibres.col(t) = direction(barycentre(mesh, t));
    const TetMesh fine = refine(mesh).mesh;
    double found = 0, kept = 0;
    for (Index t = 0; t < fine.tet_count(); ++t) {
      const Vec3d x = barycentre(fine, t);
      if ((x.array() < 0.3).any() || (x.array() > 0.7).any()) continue;
      found = std::max(found, (fine.fibres.col(t) - direction(x)).norm());
      kept = std::max(kept, (mesh.fibres.col(t / 8) - direction(x)).norm());
    }
    CHECK(found < 0.5 * kept);
    return found;
  };
  CHECK(std::log2(worst(5) / worst(10)) > 1.5);
}

TEST_CASE("a written scene is read as the same one") {
  for (const std::string fibre : {R"({"direction": [3, 0, 1]})", R"({"array": "fibre"})",
                                  R"({"axis": {"point": [0, 5, 0], "direction": [0, 1, 0]}})",
                                  R"({"harmonic": {"from": {"label": [1]}, "to": {"vertices": [2]}}})"}) {
    const std::string once = to_json(scene_of(fibrous(fibre)));
    CHECK(to_json(parse_scene(once)) == once);
    CHECK(once.find("young_modulus_along") != std::string::npos);
  }
  const std::string neo = to_json(scene_of({{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "neo-hookean"}}));
  CHECK(neo.find("neo-hookean") != std::string::npos);
  CHECK(to_json(parse_scene(neo)) == neo);
  const std::string yeoh = to_json(scene_of(
      {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "yeoh"}, {"yeoh_c2", 1500}, {"yeoh_c3", 800}}));
  const std::string mooney = to_json(
      scene_of({{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "mooney-rivlin"}, {"mooney_c01", 2e3}}));
  CHECK(parse_scene(mooney).materials.at(0).further[0] == 2e3);
  CHECK(to_json(parse_scene(mooney)) == mooney);
  const std::string holzapfel = to_json(scene_of(artery()));
  const Elastic wall = elastic_of(parse_scene(holzapfel).materials.at(0));
  CHECK(wall.law == MaterialLaw::holzapfel);
  CHECK(wall.further == std::array<double, 2>{2e3, 0.8});
  CHECK(wall.fibre_angle == near(std::numbers::pi / 6, 1e-15));
  CHECK(wall.fibre_plane == std::array<double, 3>{0, 1, 0});
  CHECK(to_json(parse_scene(holzapfel)) == holzapfel);
  const Scene again = parse_scene(yeoh);
  CHECK(again.materials.at(0).law == MaterialLaw::yeoh);
  CHECK(again.materials.at(0).further == std::array<double, 2>{1500, 800});
  CHECK(to_json(again) == yeoh);
}

TEST_CASE("moduli that are not those of the law, or make no solid, are named") {
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  json material = {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "neo-hookean"}, {"yeoh_c2", 1500}};
  has(fault_of(material),
      "/materials/0/yeoh_c2: is a modulus of \"law\": \"yeoh\", but the law is \"neo-hookean\"");
  material = {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "yeoh"}, {"yeoh_c2", -1500}};
  has(fault_of(material), "yeoh_c2");
  material = {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"law", "mooney-rivlin"}, {"mooney_c01", 6e3}};
  has(fault_of(material), "mooney_c01 must be at least 0 and at most lame_mu / 2");
}

TEST_CASE("what is wrong with both families of fibres of a law is named") {
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  const auto without = [](const char* key) {
    json material = artery();
    material.erase(key);
    return fault_of(material);
  };
  const auto with = [](const char* key, const json& value) {
    json material = artery();
    material[key] = value;
    return fault_of(material);
  };
  CHECK(fault_of(artery()) == "");
  has(without("fibre"), "/materials/0/fibre: is missing");
  has(without("holzapfel_plane"), "holzapfel_plane is missing");
  has(without("holzapfel_k1"), "holzapfel_k1 must be above 0");
  has(with("holzapfel_angle", 91), "/materials/0/holzapfel_angle: 91, must be at most 90");
  has(with("holzapfel_plane", {2, 0, 0}),
      "/materials/0/holzapfel_plane: is the direction of the fibre of tetrahedron 0; it must be another");
  has(with("law", "svk"), "is a modulus of \"law\": \"holzapfel\"");
  json plain = {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"holzapfel_angle", 30}};
  has(fault_of(plain), "/materials/0/holzapfel_angle: is of \"law\": \"holzapfel\" alone");
  plain = {{"lame_lambda", 4e4}, {"lame_mu", 1e4}, {"fibre", {{"direction", {1, 0, 0}}}}};
  has(fault_of(plain), "/materials/0/fibre: needs constants along and across fibres");
}

TEST_CASE("what is wrong with fibres is named with its place") {
  const std::string straight = R"({"direction": [1, 0, 0]})";
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  has(fault_of(fibrous(R"({"direction": [0, 0, 0]})")),
      "/materials/0/fibre/direction: has length 0, must be above 0");
  has(fault_of(fibrous(straight, R"({"poisson_ratio_along": 1.2})")),
      "/materials/0/poisson_ratio_along: 1.2, must be within ±0.98");
  has(fault_of(fibrous(straight, R"({"shear_modulus_along": -1})")),
      "/materials/0/shear_modulus_along: -1, must be above 0");
  has(fault_of(fibrous(straight, R"({"poisson_ratio_across": 1})")),
      "/materials/0/poisson_ratio_across: 1, must be within (-1, 1)");
  has(fault_of(fibrous(R"({"array": "fibre"})")),
      "/materials/0/fibre/array: the mesh has no cell array \"fibre\"");
  TetMesh mesh = bar();
  mesh.fibres = X.replicate(1, mesh.tet_count());
  mesh.fibres(0, 5) = std::nan("");
  has(fault_of(fibrous(R"({"array": "fibre"})"), mesh), "/materials/0/fibre/array: tetrahedron 5:");
  mesh.fibres.col(5).setZero();
  has(fault_of(fibrous(R"({"array": "fibre"})"), mesh), "has length 0, must be above 0 and finite");
  mesh.fibres.col(5) = Vec3d(std::numeric_limits<double>::infinity(), 0, 0);
  has(fault_of(fibrous(R"({"array": "fibre"})"), mesh), "has length inf, must be above 0 and finite");
  has(fault_of(fibrous(R"({"axis": {"point": [0, 0, 0], "direction": [0, 0, 0]}})")),
      "/materials/0/fibre/axis/direction: has length 0, must be above 0");
  has(fault_of(fibrous(straight, R"({"young_modulus_across": 0})")), "/materials/0/young_modulus_across");
  has(fault_of(fibrous(straight, R"({"law": "neo-hookean"})")),
      "/materials/0/law: a law other than SVK does not go with a material with fibres");
  json missing = fibrous(straight);
  missing.erase("fibre");
  has(fault_of(missing), "\"fibre\"");
  missing = fibrous(straight);
  missing.erase("shear_modulus_along");
  has(fault_of(missing), "\"shear_modulus_along\"");
}

TEST_CASE("the description gives ratios of stiffness and wave speeds along and across") {
  const Scene scene = scene_of(fibrous(R"({"direction": [1, 0, 0]})", R"({"density": 900})"));
  const json summary = json::parse(describe_json(scene, resolve(scene, bar())));
  const json& fibre = summary["materials"][0]["fibre"];
  CHECK(fibre["young_ratio"].get<double>() == near(3, 1e-12));
  CHECK(fibre["shear_ratio"].get<double>() == near(2e4 * 2.7 / 3e4, 1e-12));
  const double delta = 1 - 0.35 - 2 * 0.4 * 0.4 / 3;
  CHECK(fibre["wave_speed_along_m_s"].get<double>() == near(std::sqrt(9e4 * 0.65 / delta / 900), 1e-12));
  CHECK(fibre["shear_wave_speed_along_m_s"].get<double>() == near(std::sqrt(2e4 / 900), 1e-12));
  CHECK(describe(scene, resolve(scene, bar())).find(", ratio 3, of shear 1.8; waves ") != std::string::npos);
}

TEST_CASE("the shipped ventricle is the generator's, and its scene takes the fibres of the file") {
  const std::filesystem::path data = LOBE_DATA_DIR;
  const TetMesh made = ventricle_mesh({}, 12, 3),
                shipped = read_mesh(data / "meshes" / "ventricle_8k.vtu").mesh;
  CHECK((made.points - shipped.points).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(made.tets == shipped.tets);
  const Setup setup = resolve(read_scene(data / "scenes" / "ventricle.json"), shipped).setup;
  CHECK((setup.mesh.fibres - made.fibres).cwiseAbs().maxCoeff() < 1e-15);
}
