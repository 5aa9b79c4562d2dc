// Copies of tetrahedra that share their volume, as a blade leaves them.
#include <doctest/doctest.h>

#include "doubled.h"
#include "fibre_support.h"
#include "lattice/lattice_worlds.h"
#include "lobe/diagnostics/fields.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup clamped(Setup setup) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.005) setup.prescribed.push_back({v});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

double gap_between(const Mat3X<double>& a, const Mat3X<double>& b) { return (a - b).norm() / b.norm(); }

void check_that_doubled_is_the_same(const Setup& plain) {
  const Mat3X<double> u = random_displacement(plain.mesh.vertex_count(), 1e-3);
  World<double> one = world_at(plain, u), two = world_at(doubled(plain), u);
  CHECK(gap_between(two.forces(), one.forces()) < 1e-12);
  CHECK(gap_between(two.state().u, one.state().u) < 1e-12);
  for (std::size_t v = 0; v < one.body().inertia.mass().size(); ++v)
    CHECK(std::abs(two.body().inertia.mass()[v] - one.body().inertia.mass()[v]) <=
          1e-12 * one.body().inertia.mass()[v]);
  CHECK(two.energies().total() == near(one.energies().total(), 1e-12));
  CHECK(current_volume(two.elements(), u) == near(current_volume(one.elements(), u), 1e-12));
  if (plain.integrator == Integrator::central_difference)
    CHECK(two.time_step_limit() == near(one.time_step_limit(), 1e-12));
  one.advance(0.01);
  two.advance(0.01);
  CHECK(gap_between(two.state().u, one.state().u) < 1e-10);  // of many steps
}

}  // namespace

TEST_CASE("a non-linear body of doubled tetrahedra that share their volume is the plain one") {
  Setup setup = clamped(setup_of(irregular_box()));
  setup.volume_penalty = 1e5;
  setup.guard_below = 0.3;
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("so it is with fibres, in every region, and with a neo-Hookean material") {
  Setup fibrous = clamped(fibrous_setup(irregular_box()));
  check_that_doubled_is_the_same(fibrous);
  for (std::size_t t = 0; t < fibrous.region_of.size(); t += 2)
    fibrous.region_of[t] = RegionModel::tensor_mass;
  check_that_doubled_is_the_same(fibrous);
  check_that_doubled_is_the_same(clamped(neo_hookean_setup(irregular_box())));
}

TEST_CASE("so it is with smoothed edges, alone and with volume term and guard") {
  Setup setup = clamped(smoothed(setup_of(irregular_box())));
  check_that_doubled_is_the_same(setup);
  setup.volume_penalty = 1e5;
  setup.guard_below = 0.3;
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("so it is with nodal pressure") {
  check_that_doubled_is_the_same(clamped(averaged(hybrid_setup(irregular_box()))));
}

TEST_CASE("so it is with tensor-mass regions") {
  check_that_doubled_is_the_same(clamped(hybrid_setup(irregular_box())));
  check_that_doubled_is_the_same(clamped(setup_of(irregular_box(), RegionModel::tensor_mass)));
}

TEST_CASE("so it is with precomputed regions, in a fixed frame and in one that turns along") {
  Setup setup = clamped(setup_of(irregular_box(4)));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if ((tet_points(setup.mesh, t).row(0).array() < 0.025).all())
      setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  check_that_doubled_is_the_same(setup);
  setup.precomputed_frame = RegionFrame::corotated;
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("so it is with selective masses") {
  Setup setup = clamped(hybrid_setup(irregular_box()));
  setup.selective_mass = 2;
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("so it is with reduced regions") {
  Setup setup = bar(12, 4);
  setup.gravity = {0, 0, -1};
  setup.damping = 10;
  World<double> one(setup), two(doubled(setup));
  REQUIRE(region_of(one).any_embedded());
  CHECK(region_of(two).embedding().vertices == region_of(one).embedding().vertices);
  const std::vector<double>&a = region_of(one).embedding().mass, &b = region_of(two).embedding().mass;
  REQUIRE(a.size() == b.size());
  for (std::size_t n = 0; n < a.size(); ++n) CHECK(std::abs(b[n] - a[n]) <= 1e-12 * a[n]);
  CHECK(two.time_step_limit() == near(one.time_step_limit(), 1e-12));
  int embedded = 0, full = 0;  // frames: the bar is full while it swings
  for (int i = 0; i < 50; ++i) {
    one.advance(0.02);
    two.advance(0.02);
    ++(region_of(one).any_embedded() ? embedded : full);
    CHECK(region_of(two).embedding().vertices == region_of(one).embedding().vertices);
  }
  CHECK(embedded > 3);
  CHECK(full > 3);
  CHECK(gap_between(two.state().u, one.state().u) < 1e-10);  // of many steps
  CHECK(two.energies().total() == near(one.energies().total(), 1e-10));
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("so it is with implicit dynamics") {
  Setup setup = clamped(averaged(hybrid_setup(irregular_box())));
  setup.integrator = Integrator::generalised_alpha;
  setup.implicit_step = 2e-3;
  check_that_doubled_is_the_same(setup);
}

TEST_CASE("a share that is not above 0 and at most 1 is refused") {
  Setup setup = setup_of(irregular_box(1));
  setup.shares.assign(std::size_t(setup.mesh.tet_count()), 1);
  for (const double wrong : {0.0, -0.5, 1.5, std::nan("")}) {
    setup.shares[0] = wrong;
    CHECK_THROWS_WITH(World<double>{setup}, doctest::Contains("a share of volume must be above 0"));
  }
  setup.shares.resize(1);
  CHECK_THROWS_WITH(World<double>{setup}, doctest::Contains("one entry per tetrahedron, or none"));
}
