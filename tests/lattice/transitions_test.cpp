// Energies of reduced regions when vertices are embedded, or become full.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <optional>

#include "lattice_worlds.h"
#include "lobe/forces/force_term.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Bent by its weight.
Setup heavy_bar(RegionModel model = RegionModel::reduced) {
  Setup setup = bar(12, 4, true, model);
  setup.gravity = {0, 0.3, -1};
  setup.damping = 10;
  return setup;
}

// Swings, but slowly.
World<double> swinging(const Setup& setup) {
  World<double> world(setup);
  for (int i = 0; i < 25; ++i) REQUIRE(world.advance(0.02).ok);
  world.body().synchronise_velocities();
  return world;
}

std::vector<Index> all_tets(const Setup& setup) {
  std::vector<Index> all(std::size_t(setup.mesh.tet_count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// What a command changes is what the next report says.
template <class Act>
Transitions check_reported(World<double>& world, Act&& act) {
  const Energies before = world.energies();
  act();
  const Energies after = world.energies();
  const double scale = before.elastic() + before.kinetic;
  const Transitions found = world.save().transitions;
  CHECK(std::abs(found.kinetic - (after.kinetic - before.kinetic)) < 1e-12 * scale);
  CHECK(std::abs(found.elastic - (after.elastic() - before.elastic())) < 1e-12 * scale);
  CHECK(std::abs(found.loads - (after.loads - before.loads)) < 1e-12 * scale);
  CHECK(std::abs(found.total() - (after.total() - before.total())) < 1e-12 * scale);
  return found;
}

// A spring at a vertex from a time on, to where the vertex then is. The step limit is not told of it.
class HiddenSpring : public ForceTerm<double> {
 public:
  HiddenSpring(Index vertex, double stiffness, double begin)
      : vertex_(vertex), stiffness_(stiffness), begin_(begin) {}
  std::string name() const override { return "hidden spring"; }
  void add_forces(const At& at, Mat3X<double>& f) override {
    if (at.time < begin_ - 1e-9) return;
    if (!anchor_) anchor_ = at.u.col(vertex_);
    f.col(vertex_) -= stiffness_ * (at.u.col(vertex_) - *anchor_);
  }
  std::vector<Index> acts_on(const Model&) const override { return {vertex_}; }

 private:
  Index vertex_;
  double stiffness_;  // [N/m]
  double begin_;      // [s]
  std::optional<Vec3d> anchor_;
};

// The frame in which the bar's end is let go, with a spring at it that is too stiff for steps of `step`; 0:
// no spring.
Report let_go(const Setup& setup, double step) {
  World<double> world(setup);
  const double time = setup.grasps.front().path.back().time;
  const Index vertex = vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.006).front();
  const double mass = World<double>(all_nonlinear(setup)).body().inertia.mass()[std::size_t(vertex)];
  const double stiffness = step > 0 ? mass * std::pow(2 / step, 2) : 0;
  world.add(std::make_shared<HiddenSpring>(vertex, stiffness, time));
  for (int i = 0; i < 25; ++i) REQUIRE(world.advance(time / 25).ok);
  return world.advance(0.01);
}

}  // namespace

TEST_CASE("the energy that a lattice loses when it takes over is reported, once") {
  const Setup setup = heavy_bar(RegionModel::nonlinear);
  World<double> world = swinging(setup);
  const Transitions first = check_reported(world, [&] {
    world.apply(SetRegion{all_tets(setup), RegionModel::reduced});
  });
  CHECK(region_of(world).any_embedded());
  CHECK(first.count == 1);
  CHECK(first.elastic != 0);
  CHECK(first.kinetic != 0);
  CHECK(std::abs(first.total()) < 0.1 * world.energies().elastic());
  World<double> restored(setup);
  restored.restore(world.save());
  for (World<double>* each : {&world, &restored}) {
    const Report report = each->advance(1e-6);
    CHECK(report.transitions.count == 1);
    CHECK(report.transitions.elastic == first.elastic);
    CHECK(each->advance(1e-6).transitions.count == 0);
  }
}

TEST_CASE("the energy that freeing changes is reported: cells become tetrahedra, nodes become vertices") {
  const Setup setup = heavy_bar();
  World<double> world = swinging(setup);
  REQUIRE(region_of(world).full_tet_count() < setup.mesh.tet_count());
  const Index v = vertices_near(setup.mesh, {0.12, 0.02, 0.02}, 0.012).front();
  const Mat3X<double> u = world.state().u;
  const Transitions zone = check_reported(world, [&] { world.apply(SetForces{{{v, Vec3d::Zero()}}}); });
  CHECK_FALSE(region_of(world).embeds(v));
  CHECK(zone.count == 1);
  CHECK(zone.elastic != 0);
  CHECK((world.state().u - u).norm() < 1e-15);

  REQUIRE(world.advance(1e-6).transitions.count == 1);
  world.body().synchronise_velocities();
  const Transitions all = check_reported(world, [&] {
    world.apply(SetRegion{all_tets(setup), RegionModel::nonlinear});
  });
  CHECK_FALSE(region_of(world).any());
  CHECK(all.elastic != 0);
}

TEST_CASE("the energy of a zone that is embedded again is reported") {
  const Setup setup = heavy_bar();
  World<double> world = swinging(setup);
  const Index v = vertices_near(setup.mesh, {0.12, 0.02, 0.02}, 0.012).front();
  world.apply(SetForces{{{v, Vec3d::Zero()}}});
  world.apply(SetForces{{}});
  REQUIRE(world.advance(FullZones::linger + 0.01).ok);  // zones change between frames
  CHECK_FALSE(region_of(world).embeds(v));
  world.body().synchronise_velocities();
  const Transitions zone = check_reported(world, [&] { world.apply(SetForces{{}}); });
  CHECK(region_of(world).embeds(v));
  CHECK(zone.count == 1);
  CHECK(zone.total() != 0);
}

TEST_CASE("a body that is taken hold of is full at once, and the report of that frame says what it changed") {
  Setup setup = heavy_bar();
  setup.grasps.push_back({"grasp",
                          vertices_near(setup.mesh, {0.12, 0.02, 0.02}, 0.016),
                          {{0.2, Vec3d::Zero()}, {0.5, Vec3d(0, 0, 0.002)}},
                          false});
  World<double> world(setup);
  int count = 0;
  double sum = 0, largest = 0;
  for (int i = 0; i < 30; ++i) {
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    count += report.transitions.count;
    sum += std::abs(report.transitions.total());
    const Energies e = world.energies();
    largest = std::max(largest, e.elastic() + e.kinetic);
  }
  MESSAGE(count << " transitions, by " << sum / largest << " of the largest energy");
  CHECK(count >= 3);
  CHECK(sum > 0);
  CHECK(sum < 0.2 * largest);
}

TEST_CASE(
    "a frame that seems to swing has 1.15 times the steps in its second try if the lattice gives back") {
  for (RegionModel model : {RegionModel::reduced, RegionModel::nonlinear}) {
    CAPTURE(model);
    const Setup setup = pulled_bar(model);
    const Report plain = let_go(setup, 0);
    REQUIRE(plain.ok);
    REQUIRE(plain.reruns == 0);
    CHECK((plain.transitions.count > 0) == (model == RegionModel::reduced));
    const Report swung = let_go(setup, plain.time_step);
    CHECK(swung.ok);
    CHECK(swung.reruns == 1);
    const double steps = std::round(0.01 / plain.time_step);
    const double more = model == RegionModel::reduced ? std::ceil(1.15 * steps) : 2 * steps;
    CHECK(0.01 / swung.time_step == near(more, 1e-12));
  }
}

TEST_CASE("a body without reduced regions has no transitions") {
  World<double> world(bar(4, 2, true, RegionModel::nonlinear));
  world.apply(SetRegion{{0, 1, 2}, RegionModel::tensor_mass});
  CHECK(world.advance(0.01).transitions.count == 0);
}
