#include "painting.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/read_scene.h"
#include "lobe/sim/world.h"
#include "near.h"

using namespace lobe;
using namespace lobe::view;
using lobe::test::Folder;
using lobe::test::near;

namespace {

// A box of 0.1 m whose lower half has the label 5, where the material is another one, and whose bottom is
// fixed.
struct Painted {
  TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, 4, 4, 4);
  Scene scene = parse_scene(R"({
    "name": "box", "mesh": "box.vtu",
    "materials": [{"name": "soft", "lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000},
                  {"name": "firm", "lame_lambda": 8e4, "lame_mu": 2e4, "density": 1000, "where": {"label": 5}}],
    "regions": [{"name": "all", "model": "nonlinear"}],
    "boundary": [{"fix": true, "where": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "side": "below"}}}],
    "time": {"duration": 1}})");
  Resolved resolved;

  Painted() {
    mesh.labels.assign(std::size_t(mesh.tet_count()), 0);
    for (Index t = 0; t < mesh.tet_count(); ++t)
      if (barycentre(mesh, t).z() < 0.05) mesh.labels[std::size_t(t)] = 5;
    resolved = resolve(scene, mesh);
  }
};

Resolved resolve_again(const Painting& painting) {
  return resolve(painting.scene("box.vtu"), painting.mesh());
}

}  // namespace

TEST_CASE("a scene that nobody painted on comes to the same setup") {
  const Painted painted;
  const Painting painting(painted.scene, painted.resolved);
  const Setup setup = resolve_again(painting).setup;
  CHECK(setup.region_of == painted.resolved.setup.region_of);
  CHECK(setup.material_of == painted.resolved.setup.material_of);
  CHECK(setup.prescribed.size() == painted.resolved.setup.prescribed.size());
}

TEST_CASE("what sleeps may be painted as a lattice, which does not sleep") {
  Painted painted;
  painted.scene.time.sleep = 1e-5;
  Painting painting(painted.scene, painted.resolved);
  painting.paint_all(RegionModel::tensor_mass);
  CHECK(resolve_again(painting).setup.sleep == 1e-5);
  painting.paint_all(RegionModel::reduced);
  CHECK_FALSE(painting.scene("box.vtu").time.sleep);
}

TEST_CASE("what was painted is what the scene comes to, and materials by label stay where they were") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint({0.1, 0.1, 0.05}, 0.04, RegionModel::tensor_mass);
  painting.paint({0.05, 0.05, 0}, 0.04, RegionModel::precomputed);
  const Setup setup = resolve_again(painting).setup;
  CHECK(setup.region_of == painting.regions());
  CHECK(setup.material_of == painted.resolved.setup.material_of);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Vec3d centre = barycentre(setup.mesh, t);
    if ((centre - Vec3d(0.1, 0.1, 0.05)).norm() < 0.04)
      CHECK(setup.region_of[std::size_t(t)] == RegionModel::tensor_mass);
  }
  const auto shares = painting.shares();
  CHECK(shares[0] > 0);
  CHECK(shares[1] > 0);
  CHECK(shares[0] + shares[1] + shares[2] == near(1, 1e-12));
}

TEST_CASE("materials are painted, and a new one has the stiffness that it was given") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  const int hard = painting.add_material("hard", 1e5);
  CHECK(hard == 2);
  CHECK_THROWS_AS(painting.add_material("hard", 1e4), InputError);
  CHECK_THROWS_AS(painting.add_material("none", 0), InputError);
  CHECK_THROWS_AS(painting.paint_material({0, 0, 0}, 0.01, 3), InputError);
  painting.paint_material({0.1, 0.1, 0.1}, 0.06, hard);
  painting.paint({0.1, 0.1, 0.05}, 0.05, RegionModel::tensor_mass);
  const std::vector<double> shares = painting.material_shares();
  CHECK(shares[2] > 0);
  CHECK(shares[0] + shares[1] + shares[2] == near(1, 1e-12));
  const Setup setup = resolve_again(painting).setup;
  CHECK(setup.region_of == painting.regions());
  for (std::size_t t = 0; t < setup.material_of.size(); ++t)
    CHECK(int(setup.material_of[t]) == painting.material_of()[t]);
  const Elastic& material = setup.materials[2];
  CHECK(young_modulus(material.lambda, material.mu) == near(1e5, 1e-12));
  CHECK(poisson_ratio(material.lambda, material.mu) == near(0.4, 1e-12));
  painting.undo();
  painting.undo();
  CHECK(painting.material_shares()[2] == 0);
}

TEST_CASE("a new material beside one with fibres has them, and all its moduli grow alike") {
  Painted painted;
  Material& first = painted.scene.materials[0];
  first.transverse = {9e4, 3e4, 0.4, 0.35, 2e4};
  first.fibre = FibreDirection{Vec3d(0, 3, 4)};
  painted.resolved = resolve(painted.scene, painted.mesh);
  CHECK(young_of(first) == 3e4);
  Painting painting(painted.scene, painted.resolved);
  const int hard = painting.add_material("hard", 6e4);
  painting.paint_material({0.1, 0.1, 0.1}, 0.06, hard);
  const Setup setup = resolve_again(painting).setup;
  const TransverseConstants constants = transverse_constants(setup.materials[std::size_t(hard)]);
  CHECK(constants.young_along == near(18e4, 1e-12));
  CHECK(constants.young_across == near(6e4, 1e-12));
  CHECK(constants.shear_along == near(4e4, 1e-12));
  CHECK(constants.poisson_along == near(0.4, 1e-12));
  CHECK(constants.poisson_across == near(0.35, 1e-12));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (setup.material_of[std::size_t(t)] != 1)
      CHECK((setup.mesh.fibres.col(t) - Vec3d(0, 0.6, 0.8)).norm() < 1e-15);
}

TEST_CASE("a material that nothing is left of is not in the scene") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint_material({0.05, 0.05, 0.05}, 1, 1);
  const Scene scene = painting.scene("box.vtu");
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].name == "firm");
  CHECK(resolve_again(painting).setup.materials[0].lambda == 8e4);
}

TEST_CASE("the surface shows what was painted") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint({0.1, 0.1, 0.1}, 0.03, RegionModel::precomputed);
  const SurfaceMesh& surface = painting.surface();
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    CHECK(surface.region[i] == painting.regions()[std::size_t(surface.owner[i].tet)]);
}

TEST_CASE("a brush smaller than a tetrahedron paints the nearest") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint({0.05, 0.05, 0.1}, 1e-6, RegionModel::tensor_mass);
  CHECK(std::count(painting.regions().begin(), painting.regions().end(), RegionModel::tensor_mass) == 1);
}

TEST_CASE("what is held can be painted, on the skin alone") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.hold({0.05, 0.05, 0}, 1, false);
  painting.hold({0.05, 0.05, 0.1}, 0.052, true);
  const Setup setup = resolve_again(painting).setup;
  REQUIRE(!setup.prescribed.empty());
  for (const PrescribedVertex& item : setup.prescribed)
    CHECK(setup.mesh.points(2, item.vertex) == near(0.1, 1e-12));
}

TEST_CASE("a stroke is undone at once") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  CHECK_FALSE(painting.can_undo());
  painting.paint({0, 0, 0}, 0.03, RegionModel::tensor_mass);
  painting.paint({0.05, 0, 0}, 0.03, RegionModel::tensor_mass);
  painting.end_stroke();
  const std::vector<RegionModel> first = painting.regions();
  painting.paint_all(RegionModel::precomputed);
  CHECK(painting.shares()[1] == near(1, 1e-12));
  painting.undo();
  CHECK(painting.regions() == first);
  painting.undo();
  CHECK(painting.regions() == painted.resolved.setup.region_of);
  CHECK_FALSE(painting.can_undo());
}

TEST_CASE("precomputed parts that are held nowhere are found, and are those that no world can be built of") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint_all(RegionModel::nonlinear);
  CHECK(painting.unheld().empty());
  painting.paint({0.05, 0.05, 0.1}, 0.03, RegionModel::precomputed);
  const double share = painting.share_of(painting.unheld());
  CHECK(share == near(painting.shares()[1], 1e-12));
  CHECK_THROWS_AS(World<float>(resolve_again(painting).setup), InputError);
  CHECK(painting.can_turn());
  painting.set_frame(RegionFrame::corotated);
  CHECK(painting.unheld().empty());
  CHECK_NOTHROW(World<float>(resolve_again(painting).setup));
  painting.undo();
  painting.hold({0.05, 0.05, 0.1}, 0.03, true);
  CHECK(painting.unheld().empty());
  CHECK_NOTHROW(World<float>(resolve_again(painting).setup));
}

TEST_CASE("a scene is saved beside its mesh, and read back comes to what was painted") {
  const Painted painted;
  Painting painting(painted.scene, painted.resolved);
  painting.paint({0.05, 0.05, 0}, 0.04, RegionModel::precomputed);
  const Folder folder;
  const Scene scene = read_scene(painting.save(folder.path, "painted"));
  const Resolved again = resolve(scene, read_mesh(mesh_path(scene)).mesh);
  CHECK(again.setup.region_of == painting.regions());
  CHECK(again.setup.material_of == painted.resolved.setup.material_of);
}

TEST_CASE("a name that leads to another folder is refused") {
  for (const char* name : {"", "../organ", "a/b", "a b", "a.json"})
    CHECK_THROWS_AS(check_file_name(name), InputError);
  CHECK_NOTHROW(check_file_name("my_organ-2"));
}
