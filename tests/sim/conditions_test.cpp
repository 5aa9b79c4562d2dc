// Each condition that a report names, where it must and where it must not.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "lobe/sim/world.h"
#include "near.h"
#include "squeezed_bar.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;
using Kind = Condition::Kind;

namespace {

int times_said(const Report& report, Kind kind) {
  return static_cast<int>(std::count_if(report.conditions.begin(), report.conditions.end(),
                                        [&](const Condition& c) { return c.kind == kind; }));
}

// The report of a short frame of a block that is flattened to a share of its height.
Report flattened(double share) {
  World<double> world(setup_of(irregular_box(3)));
  State<double> state = world.state();
  state.u.row(2) = (share - 1) * world.elements().points.view().row(2);
  world.set_state(state);
  return world.advance(1e-7);
}

}  // namespace

TEST_CASE("a tetrahedron below 5 % of its volume is named with its ratio, one above is not") {
  CHECK(times_said(flattened(0.06), Kind::near_inversion) == 0);
  const Report report = flattened(0.04);
  REQUIRE(times_said(report, Kind::near_inversion) == 1);
  const auto named = std::find_if(report.conditions.begin(), report.conditions.end(),
                                  [](const Condition& c) { return c.kind == Kind::near_inversion; });
  CHECK(named->text.find("is at 0.04 of its volume") != std::string::npos);
  CHECK(report.smallest_volume_ratio == near(0.04, 1e-3));
}

TEST_CASE("a frame of more than a million steps is refused, and changes nothing") {
  World<double> world(setup_of(irregular_box(3)));
  const double limit = world.time_step_limit();
  const Report report = world.advance(2e6 * limit);
  CHECK_FALSE(report.ok);
  REQUIRE(times_said(report, Kind::too_stiff) == 1);
  CHECK(world.time() == 0);
  CHECK(world.state().u.isZero(0));
  CHECK(world.advance(2 * limit).ok);
}

TEST_CASE("where everything is cut away the next report says so, and the world goes on") {
  World<float> world(setup_of(irregular_box(3)));
  CHECK(times_said(world.advance(1e-3), Kind::everything_cut) == 0);
  std::vector<Index> all(std::size_t(world.elements().topology.tet_count()));
  std::iota(all.begin(), all.end(), 0);
  world.remove_tets(all);
  const Report report = world.advance(1e-3);
  CHECK(report.ok);
  CHECK(times_said(report, Kind::everything_cut) == 1);
  const Report next = world.advance(1e-3);
  CHECK(next.ok);
  CHECK(times_said(next, Kind::everything_cut) == 0);
  CHECK(world.state().u.allFinite());
}

TEST_CASE("selective masses that are lumped while tetrahedra are crushed are reported, each time") {
  const auto times = [](Setup setup, double degree) {
    setup.selective_mass = degree;
    World<float> world(setup);
    int times = 0;
    for (int i = 0; i < 20; ++i) {
      const Report report = world.advance(0.2);
      for (const Condition& c : report.conditions) {
        if (c.kind != Kind::lumped) continue;
        // It is said in turn that they are lumped, and that they are selective again.
        CHECK((c.text.find("are lumped") != std::string::npos) == (times % 2 == 0));
        ++times;
      }
    }
    return times;
  };
  CHECK(times(squeezed_bar(), 5) > 0);
  CHECK(times(squeezed_bar(), 1) == 0);  // there are none
  CHECK(times(setup_of(irregular_box(3)), 5) == 0);
}

TEST_CASE("a change between linear and non-linear tetrahedra is no transition and asks for no energies") {
  Setup setup = setup_of(irregular_box(3));
  for (Index t = 0; t < setup.mesh.tet_count(); t += 2)
    setup.region_of[std::size_t(t)] = RegionModel::tensor_mass;
  World<double> world(setup);
  State<double> state = world.state();
  state.u.row(0) = 0.02 * world.elements().points.view().row(0);
  world.set_state(state);
  for (const RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass}) {
    world.apply(SetRegion{{0, 1, 2, 3}, model});
    const Transitions transitions = world.advance(1e-5).transitions;
    CHECK(transitions.count == 0);
    CHECK(transitions.kinetic == 0);
    CHECK(transitions.elastic == 0);
    CHECK(transitions.loads == 0);
  }
}

TEST_CASE("a region that leaves the lattice is a transition, counted once") {
  Setup setup = setup_of(irregular_box(4));
  setup.region_of.assign(setup.region_of.size(), RegionModel::reduced);
  World<double> world(setup);
  std::vector<Index> half(setup.region_of.size() / 2);
  std::iota(half.begin(), half.end(), 0);
  world.apply(SetRegion{half, RegionModel::nonlinear});
  CHECK(world.advance(1e-5).transitions.count > 0);
  CHECK(world.advance(1e-5).transitions.count == 0);
}
