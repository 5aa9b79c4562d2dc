#include "lobe/scene/read_scene.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/scene/write_scene.h"
#include "near.h"
#include "scene/scenes.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Select>
const Select& as(const Selector& selector) {
  REQUIRE(std::holds_alternative<Select>(selector.value));
  return std::get<Select>(selector.value);
}

}  // namespace

TEST_CASE("materials are read in either form") {
  const Scene scene = parse_scene(full_scene, "dir/liver.json");
  REQUIRE(scene.materials.size() == 3);
  CHECK(scene.materials[0].name == "parenchyma");
  CHECK(!scene.materials[0].where);
  CHECK(scene.materials[0].lame_lambda == 4e4);
  CHECK(scene.materials[0].lame_mu == 1e4);
  CHECK(scene.materials[0].density == 1060);
  // λ = Eν/((1+ν)(1−2ν)) = 2.8e4/0.28, μ = E/(2(1+ν)) = 7e4/2.8
  CHECK(scene.materials[1].lame_lambda == near(1e5, 1e-14));
  CHECK(scene.materials[1].lame_mu == near(2.5e4, 1e-14));
  CHECK(scene.materials[1].density == 1000);
  CHECK(!scene.materials[0].element);
  CHECK(scene.materials[1].element == ElementType::edge_smoothed);
  CHECK(!scene.materials[0].nodal_pressure);
  CHECK(scene.materials[1].nodal_pressure == 1);
  CHECK(scene.materials[2].nodal_pressure == 0.5);
  CHECK(scene.materials[1].pointer == "/materials/1");
  CHECK(as<SelectLabel>(*scene.materials[1].where).labels == std::vector<int>{2});
  CHECK(scene.materials[2].name == "tissue");
  CHECK(as<SelectLabel>(*scene.materials[2].where).labels == std::vector<int>{3, 4});
}

TEST_CASE("regions and their selectors are read") {
  const Scene scene = parse_scene(full_scene);
  REQUIRE(scene.regions.size() == 4);
  CHECK(scene.regions[0].name == "held part");
  CHECK(scene.regions[0].model == RegionModel::precomputed);
  CHECK(scene.regions[0].frame == RegionFrame::corotated);
  CHECK(as<SelectBox>(*scene.regions[0].where).min == Vec3d(-0.1, -0.2, -0.3));
  CHECK(as<SelectBox>(*scene.regions[0].where).max == Vec3d(0, 0.1, 0.2));
  CHECK(scene.regions[1].name == "tensor-mass");
  CHECK(scene.regions[1].model == RegionModel::tensor_mass);
  CHECK(scene.regions[1].frame == RegionFrame::fixed);
  CHECK(as<SelectSphere>(*scene.regions[1].where).center == Vec3d(0.01, 0, 0));
  CHECK(as<SelectSphere>(*scene.regions[1].where).radius == 0.02);
  const auto& any = as<SelectAnyOf>(*scene.regions[2].where);
  REQUIRE(any.parts.size() == 2);
  CHECK(as<SelectTetrahedra>(any.parts[0]).tetrahedra == std::vector<Index>{1, 2});
  REQUIRE(as<SelectNot>(any.parts[1]).part.size() == 1);
  as<SelectAll>(as<SelectNot>(any.parts[1]).part[0]);
  CHECK(scene.regions[3].model == RegionModel::nonlinear);
  CHECK(!scene.regions[3].where);
}

TEST_CASE("boundary conditions are read") {
  const Scene scene = parse_scene(full_scene);
  REQUIRE(scene.boundary.size() == 4);
  CHECK(scene.boundary[0].kind == Boundary::Kind::fix);
  const auto& below = as<SelectPlane>(as<SelectAllOf>(scene.boundary[0].where).parts.at(1));
  CHECK(below.side == SelectPlane::Side::below);
  CHECK(below.normal == Vec3d(0, 0, 2));
  CHECK(scene.boundary[1].kind == Boundary::Kind::displacement);
  CHECK(scene.boundary[1].value == Vec3d(0.01, 0, 0));
  CHECK(as<SelectVertices>(scene.boundary[1].where).vertices == std::vector<Index>{12, 13});
  CHECK(scene.boundary[2].kind == Boundary::Kind::traction);
  CHECK(as<SelectPlane>(scene.boundary[2].where).side == SelectPlane::Side::within);
  CHECK(as<SelectPlane>(scene.boundary[2].where).within == 1e-6);
  CHECK(scene.boundary[3].kind == Boundary::Kind::force);
  CHECK(as<SelectNearest>(scene.boundary[3].where).count == 20);
  CHECK(as<SelectNearest>(scene.boundary[3].where).point == Vec3d(0.1, 0, 0));
}

TEST_CASE("tools, time and output are read") {
  const Scene scene = parse_scene(full_scene, "dir/liver.json");
  REQUIRE(scene.tools.size() == 3);
  CHECK(scene.tools[0].type() == "grasp");
  CHECK(scene.tools[0].as<GraspSetup>().release);
  CHECK(scene.tools[0].path().at(1).time == 1);
  CHECK(scene.tools[0].path().at(1).position == Vec3d(0, 0.05, 0.02));
  CHECK(scene.tools[1].type() == "cautery");
  CHECK(scene.tools[1].name() == "cautery");
  CHECK(scene.tools[1].as<CauterySetup>().radius == 0.006);
  CHECK(scene.tools[2].type() == "scalpel");
  CHECK(scene.tools[2].as<ScalpelSetup>().snap == 0.2);
  CHECK(scene.tools[2].path().at(1).position == Vec3d(0.03, 0.05, 0));
  CHECK(scene.tools[2].as<ScalpelSetup>().heels == std::vector<Vec3d>{{0.04, -0.05, 0.1}, {0.04, 0.05, 0.1}});
  CHECK(scene.name == "liver");
  CHECK(mesh_path(scene) == std::filesystem::path("dir/meshes/liver.vtu"));
  CHECK(scene.mesh_scale == 0.001);
  CHECK(scene.volume_penalty == 1e5);
  CHECK(scene.guard_below == 0.2);
  CHECK(scene.skin == "skin.obj");
  CHECK(scene.gravity == Vec3d(0, 0, -9.81));
  CHECK(scene.loose_pieces == LoosePieces::vanish);
  CHECK(scene.time.duration == 2);
  CHECK(scene.time.frame == 0.02);
  CHECK(scene.time.damping == 20);
  CHECK(scene.time.safety == 0.8);
  CHECK(scene.time.selective_mass == 9);
  CHECK(scene.time.ramp == 0.25);
  CHECK(scene.time.precision == Precision::double_precision);
  CHECK(scene.time.integrator == Integrator::generalised_alpha);
  CHECK(scene.output.every == 0.04);
  CHECK(scene.output.pictures == std::vector<double>{0.5, 1.5});
}

TEST_CASE("an absolute mesh path stays absolute") {
  const Scene scene = parse_scene(
      R"({"mesh": "/data/a.vtu", "materials": [{"lame_lambda": 1, "lame_mu": 1}]})", "dir/scene.json");
  CHECK(mesh_path(scene) == std::filesystem::path("/data/a.vtu"));
}

TEST_CASE("with absolute paths a scene names the same files in any folder") {
  const std::string shape = R"({"mesh": {"file": "shapes/tip.obj"}})";
  const Scene scene = parse_scene(
      R"({"mesh": "a.vtu", "skin": "b.obj", "materials": [{"lame_lambda": 1, "lame_mu": 1}],
          "tools": [{"type": "probe", "shape": )" +
          shape + R"(, "path": [[0, 0, 0, 0], [1, 0, 0, 0]]}],
          "contact": {"obstacles": [{"shape": {"mesh": {"file": "/d.obj"}}, "position": [0, 0, 0]},
                                    {"shape": {"sphere": {"radius": 1}}, "position": [0, 0, 0]}]}})",
      "dir/scene.json");
  const Scene moved = parse_scene(to_json(with_absolute_paths(scene)), "/elsewhere/scene.json");
  const std::filesystem::path folder = std::filesystem::current_path() / "dir";
  CHECK(mesh_path(moved) == folder / "a.vtu");
  CHECK(skin_path(moved) == folder / "b.obj");
  CHECK(moved.tools.at(0).as<ProbeSetup>().shape_file == folder / "shapes/tip.obj");
  CHECK(moved.obstacle_files == std::vector<std::filesystem::path>{"/d.obj", ""});
  const Scene plain = with_absolute_paths(
      parse_scene(R"({"mesh": "a.vtu", "materials": [{"lame_lambda": 1, "lame_mu": 1}]})", "scene.json"));
  CHECK(plain.mesh == std::filesystem::current_path() / "a.vtu");
  CHECK(plain.skin.empty());
}

TEST_CASE("a scene is read from its file") {
  const Folder folder;
  const auto file = folder.path / "scene.json";
  std::ofstream(file) << full_scene;
  const Scene scene = read_scene(file);
  CHECK(scene.file == file);
  CHECK(mesh_path(scene) == file.parent_path() / "meshes/liver.vtu");
  std::ofstream(file) << "{";
  CHECK_THROWS_WITH_AS(read_scene(file), doctest::Contains((file.string() + ":1:2: ").c_str()), InputError);
  std::filesystem::remove(file);
  CHECK_THROWS_WITH_AS(read_scene(file),
                       (file.string() + ": cannot be read: No such file or directory").c_str(), InputError);
}
