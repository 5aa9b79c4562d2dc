// A cautery at the lips of a cut.
#include <doctest/doctest.h>

#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Volume of what lies on either side of x = at: by grains, so it is theirs that are there.
std::array<double, 2> volumes_beside(const World<double>& world, double at) {
  std::array<double, 2> volumes{};
  const Grains& grains = *world.grains();
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) {
    if (!world.elements().topology.alive(t)) continue;
    for (Index g : grains.of(t)) {
      Mat34<double> X;
      for (int k = 0; k < 4; ++k) X.col(k) = grains.point(grains[g].points[k]);
      volumes[X.row(0).mean() > at] += signed_volume(X);
    }
  }
  return volumes;
}

}  // namespace

TEST_CASE("a cautery at one lip of a cut burns nothing of the other that it does not touch") {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  setup.materials = {{8e5, 2e5, 1000}};
  const double at = 0.065;                     // in the middle of a cell
  for (const double away : {0.001, -0.001}) {  // from the cut, of the sphere's surface
    World<double> world(setup);
    Knife knife(setup.mesh);
    knife.begin();
    const auto row = [&](double z) { return std::vector<Vec3d>{{at, -0.1, z}, {at, 0.2, z}}; };
    cut(world, {knife.sweep(row(0.2), row(-0.1)).incision});
    REQUIRE(world.elements().topology.pieces().size() == 2);
    const std::array<double, 2> before = volumes_beside(world, at);
    const double radius = 0.003;
    const ToolId id = world.tools().next_id();
    world.apply(BringCautery{"tip", radius, {at - away - radius, 0.015, 0.06}});
    world.apply(SwitchTool{id, true});
    world.apply(Lead{id, {Vec3d(at - away - radius, 0.015, -0.03)}});
    const Report report = world.advance(1e-4);
    CHECK(report.tets_removed > 10);
    const std::array<double, 2> after = volumes_beside(world, at);
    CHECK(after[0] < before[0] - 1e-7);
    if (away > 0)
      CHECK(after[1] == near(before[1], 1e-12));
    else
      CHECK(after[1] < before[1] - 1e-7);
    validate(world);
    check_connections(world);
    CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  }
}
