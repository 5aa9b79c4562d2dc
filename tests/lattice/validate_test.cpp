// validate() of worlds with reduced regions: what it accepts, and what it finds.
#include "lobe/sim/validate.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>

#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a world with a reduced region is valid after any edits, frames and a way back") {
  World<double> world(pulled_bar());
  world.advance(0.01);
  const Checkpoint<double> start = world.save();
  std::mt19937 random(3);
  const auto any = [&] {
    return static_cast<Index>(random() % std::size_t(world.elements().topology.tet_count()));
  };
  const RegionModel models[] = {RegionModel::nonlinear, RegionModel::reduced, RegionModel::tensor_mass};
  int embedded = 0;
  for (int i = 0; i < 30; ++i) {
    if (i % 3 == 0) world.apply(RemoveTets{{any(), any()}});
    world.apply(SetRegion{{any(), any()}, models[i % 3]});
    world.advance(0.01);
    CHECK_NOTHROW(validate(world));
    embedded += region_of(world).any_embedded();
  }
  CHECK(embedded > 10);
  world.restore(start);
  CHECK_NOTHROW(validate(world));
}

TEST_CASE("what does not fit together in a lattice is named") {
  const auto broken = [](const std::function<void(Dynamics<double>&)>& change) -> std::string {
    World<double> world(pulled_bar());
    world.advance(0.01);
    REQUIRE(region_of(world).any_embedded());
    change(world.body());
    return fault_of(world);
  };
  using Body = Dynamics<double>;
  const std::string start = "lobe: broken invariant: ";
  const auto any_embedded = [](const Body& body) { return body.regions.reduced().embedding().vertices[5]; };
  CHECK(broken([](Body&) {}) == "");
  CHECK(broken([](Body& body) { body.model.elements.region_of[40] = RegionModel::nonlinear; }) ==
        start + "lattice: the part of a sample");
  CHECK(broken([](Body& body) { body.motion.nodes.u(1, 3) = std::nan(""); }) ==
        start + "lattice: one finite displacement and velocity per node");
  CHECK(broken([](Body& body) { body.motion.nodes.v.conservativeResize(3, 1); }) ==
        start + "lattice: one finite displacement and velocity per node");
  CHECK(broken([&](Body& body) { body.inertia.masses()[std::size_t(any_embedded(body))] += 1e-6; }) ==
        start + "inertia: the mass of the body");
}
