#include "lobe/sim/validate.h"

#include <doctest/doctest.h>

#include <random>

#include "lobe/sim/checkpoint.h"
#include "lobe/sim/world.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup held_hybrid() {
  Setup setup = hybrid_setup(irregular_box(5));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

}  // namespace

TEST_CASE_TEMPLATE("a world is valid after any edits, frames and a way back", Real, float, double) {
  Setup setup = held_hybrid();
  setup.damping = 20;
  setup.gravity = {0, 0, -9.81};
  World<Real> world(setup);
  const Checkpoint<Real> start = world.save();
  std::mt19937 random(7);
  const auto any = [&](Index count) { return static_cast<Index>(random() % std::size_t(count)); };
  const RegionModel models[] = {RegionModel::tensor_mass, RegionModel::nonlinear};
  validate(world);
  for (int i = 0; i < 20; ++i) {
    const Index tet = any(world.elements().topology.tet_count());
    world.apply(RemoveTets{{tet, any(world.elements().topology.tet_count())}});
    world.apply(SetRegion{{any(world.elements().topology.tet_count())}, models[i % 2]});
    if (i % 5 == 0) world.advance(0.002);
    CHECK_NOTHROW(validate(world));
  }
  world.restore(start);
  CHECK_NOTHROW(validate(world));
}

TEST_CASE("what does not fit together is named") {
  const auto broken = [](auto&& change) -> std::string {
    World<double> world(held_hybrid());
    world.surface();
    world.remove_tets({100, 101});
    validate(world);
    change(world.body());
    return fault_of(world);
  };
  using Body = Dynamics<double>;
  const std::string start = "lobe: broken invariant: ";
  CHECK(broken([](Body&) {}).empty());
  CHECK(broken([](Body& body) { body.model.elements.topology.remove(std::vector<Index>{7}); }) != "");
  CHECK(broken([](Body& body) { body.model.elements.region_of[0] = RegionModel::precomputed; }) ==
        start + "regions: which tetrahedra are condensed");
  CHECK(broken([](Body& body) { body.model.elements.material_of[3] = 77; }) ==
        start + "elements: a material's number");
  CHECK(broken([](Body& body) { body.model.elements.points.col(40) *= -5; }) ==
        start + "elements: a tetrahedron's rest volume");
  CHECK(broken([](Body& body) { body.motion.u.col(50)[1] = std::nan(""); }) ==
        start + "motion: the state is not finite");
  CHECK(broken([](Body& body) { body.inertia.masses()[60] *= 1 + 1e-9; }) ==
        start + "inertia: a vertex's mass");
  CHECK(broken([](Body& body) {
          body.model.held.hold({200, 1, Vec3d::Zero(), Vec3d::Zero()});
        }) == start + "inertia: an inverse mass");
  CHECK(broken([](Body& body) {
          const Index tet = 2;
          auto& model = body.model.elements.region_of[tet];
          model = model == RegionModel::nonlinear ? RegionModel::tensor_mass : RegionModel::nonlinear;
        }) != "");
}
