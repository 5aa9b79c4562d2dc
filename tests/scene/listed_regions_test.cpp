#include "lobe/scene/listed_regions.h"

#include <doctest/doctest.h>

#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;

namespace {

Scene held(const std::string& more) {
  return parse_scene(R"({"mesh": "m.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
      "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}], )" +
                     more + "}");
}

// What the scene comes to when it is written, and read again.
Setup written(const Scene& scene, const TetMesh& mesh) {
  return resolve(parse_scene(to_json(scene)), mesh).setup;
}

}  // namespace

TEST_CASE("listed regions come to the same models, with frame, cells and tolerance of the former ones") {
  const TetMesh mesh = box_mesh({0.4, 0.1, 0.1}, 12, 3, 3);
  std::vector<RegionModel> models(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const double x = barycentre(mesh, t).x();
    if (x < 0.1) models[std::size_t(t)] = RegionModel::precomputed;
    if (x > 0.2) models[std::size_t(t)] = RegionModel::tensor_mass;
  }
  Scene scene = held(R"("regions": [{"model": "precomputed", "frame": "corotated"}])");
  list_regions(models, scene);
  CHECK(scene.regions.size() == 2);
  const Setup setup = written(scene, mesh);
  CHECK(setup.region_of == models);
  CHECK(setup.precomputed_frame == RegionFrame::corotated);

  Scene reduced = held(R"("regions": [{"model": "reduced", "cell": 0.06, "tolerance": 0.03}])");
  list_regions(std::vector(models.size(), RegionModel::reduced), reduced);
  CHECK(written(reduced, mesh).lattice_cell == 0.06);
  CHECK(reduced.reduced_tolerance() == 0.03);
}

TEST_CASE("listed regions take the place of those that lobe would choose") {
  const TetMesh mesh = box_mesh({0.4, 0.1, 0.1}, 4, 1, 1);
  Scene scene = held(R"("regions": {"auto": {"tolerance": 0.01}})");
  list_regions(std::vector(std::size_t(mesh.tet_count()), RegionModel::nonlinear), scene);
  const Resolved resolved = resolve(scene, mesh);
  CHECK_FALSE(resolved.proposal);
  CHECK(scene.regions.empty());
}

TEST_CASE("a scene states the reduced regions that lobe has chosen, and comes to the same") {
  const TetMesh mesh = box_mesh({0.4, 0.1, 0.1}, 48, 12, 12);
  Scene scene = held(R"("regions": {"auto": {"reduced": true}}, "time": {"selective_mass": 12})");
  const Setup setup = resolve(scene, mesh).setup;
  REQUIRE(setup.region_of[0] == RegionModel::reduced);
  state_regions(setup, scene);
  const Setup again = written(scene, mesh);
  CHECK(again.region_of == setup.region_of);
  CHECK(again.selective_mass == setup.selective_mass);
}

TEST_CASE("a scene that leaves nothing to lobe is stated as it is") {
  const TetMesh mesh = box_mesh({0.4, 0.1, 0.1}, 4, 1, 1);
  Scene scene = held(
      R"("regions": [{"model": "tensor-mass", "where": {"nearest": {"point": [0, 0, 0], "count": 1}}}])");
  const std::string before = to_json(scene);
  state_regions(resolve(scene, mesh).setup, scene);
  CHECK(to_json(scene) == before);
}
