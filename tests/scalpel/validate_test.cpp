// validate() of worlds that blades have cut: what it finds in the grains.
#include "lobe/sim/validate.h"

#include <doctest/doctest.h>

#include <functional>

#include "sinking_block.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("what does not fit together between grains and tetrahedra is named") {
  const auto broken = [](const std::function<void(Elements&)>& change) -> std::string {
    const Setup setup = sinking_block();
    World<double> world(setup);
    cut(world, incisions_of(setup.mesh, 2));
    REQUIRE(world.elements().topology.tet_copy_count() > 0);
    change(world.body().model.elements);
    return fault_of(world);
  };
  const std::string start = "lobe: broken invariant: ";
  CHECK(broken([](Elements&) {}) == "");
  CHECK(broken([](Elements& elements) {
          elements.shares.back() *= 0.5;
          elements.corner_volumes.back() = elements.volume(elements.topology.tet_count() - 1) / 4;
        }) == start + "grains: the share of a tetrahedron");
}
