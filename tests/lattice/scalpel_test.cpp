// A blade cuts through a reduced region: what it meets becomes non-linear first. A lattice that takes over
// again has cells of their own on both sides of the slit.
#include <doctest/doctest.h>

#include <algorithm>

#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar that hangs by its weight from one end. A blade goes into it from above, half-way along and down to
// this height, and out again. Cells of the lattice are 20 mm large, with borders at 10 and 30 mm.
Setup incised_bar(RegionModel model = RegionModel::reduced, double lowest = 0.003) {
  Setup setup = bar(16, 4, true, model);
  setup.gravity = {0, 0, -1};
  setup.damping = 10;
  const Vec3d above(0.083, -0.01, 0.06), inside(0.083, -0.01, lowest), along(0, 0.06, 0);
  setup.scalpels = {{"blade",
                     0.1,
                     {{0.05, above}, {0.15, inside}, {0.25, above}},
                     {above + along, inside + along, above + along}}};
  return setup;
}

// How far a vertex and its copy have come apart at most [m].
double opening(World<double>& world) {
  const Topology& topology = world.elements().topology;
  const State<double> state = world.state();
  const Index first_copy = topology.vertex_count() - topology.copy_count();
  double widest = 0;
  for (Index v = first_copy; v < topology.vertex_count(); ++v)
    if (!topology.around(v).empty())
      widest = std::max(widest, (state.u.col(v) - state.u.col(topology.origin(v))).norm());
  return widest;
}

double play(World<double>& world, int frames) {  // returns the area that was cut [m²]
  double area = 0;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    area += report.cut_area;
    validate(world);
  }
  return area;
}

double volume_of(const World<double>& world) {  // [m³]
  double sum = 0;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) sum += world.elements().volume(t);
  return sum;
}

std::vector<Index> alive_tets(const World<double>& world) {
  std::vector<Index> alive;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t)
    if (world.elements().topology.alive(t)) alive.push_back(t);
  return alive;
}

}  // namespace

TEST_CASE("a blade cuts a reduced bar as a non-linear one") {
  World<double> world(incised_bar()), exact(incised_bar(RegionModel::nonlinear));
  REQUIRE(region_of(world).any_embedded());
  const double area = play(world, 50), exact_area = play(exact, 50);
  CHECK(area == near(exact_area, 0.05));
  CHECK(area > 0.8 * 0.04 * 0.037);
  CHECK(world.elements().topology.copy_count() > 10);
  CHECK(region_of(world).any_embedded());
  CHECK(opening(world) == near(opening(exact), 0.1));
  CHECK(volume_of(world) == near(volume_of(World<double>(incised_bar())), 1e-12));
}

TEST_CASE("a lattice that takes over where a slit is leaves it open, wherever in a cell it ends") {
  for (const double lowest : {-0.005, 0.001, 0.003, 0.007, 0.012}) {
    CAPTURE(lowest);
    World<double> world(incised_bar(RegionModel::reduced, lowest)),
        exact(incised_bar(RegionModel::nonlinear, lowest));
    play(world, 50);
    play(exact, 50);
    const double open = opening(world);
    const auto embedded_before = region_of(world).embedding().vertices.size();
    world.apply(SetRegion{alive_tets(world), RegionModel::reduced});
    CHECK(opening(world) == near(open, 1e-3));
    play(world, 50);
    play(exact, 50);
    CHECK(opening(world) == near(opening(exact), 0.02));
    CHECK(region_of(world).embedding().vertices.size() > embedded_before);
  }
}

TEST_CASE("a world whose reduced region a blade has cut goes on with the same bits from a checkpoint") {
  World<double> world(incised_bar());
  play(world, 8);  // the blade is inside
  REQUIRE(world.elements().topology.copy_count() > 0);
  World<double> restored(incised_bar());
  restored.restore(world.save());
  for (int i = 0; i < 10; ++i) {
    world.advance(0.02);
    restored.advance(0.02);
    CHECK(same_bits(world, restored));
  }
}
