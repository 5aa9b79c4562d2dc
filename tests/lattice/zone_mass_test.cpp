// Mass next to a lattice that keeps the step (zone_mass.h).
#include <doctest/doctest.h>

#include <cmath>

#include "folder.h"
#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/time/step_limit.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Pulled far at its end, and held there.
Setup stretched_bar(RegionModel model = RegionModel::reduced) {
  Setup setup = pulled_bar(model);
  const Vec3d far(0.1, 0.03, 0.02);
  setup.grasps[0].path = {{0.05, Vec3d::Zero()}, {0.45, far}, {10, far}};
  return setup;
}

// The tetrahedra of which two of three are burnt, so that slivers are left at the cut.
std::vector<Index> burnt(const TetMesh& mesh) {
  std::vector<Index> tets;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const double x = tet_points(mesh, t).row(0).mean();
    if (x > 0.07 && x < 0.09 && t % 3 != 0) tets.push_back(t);
  }
  return tets;
}

}  // namespace

TEST_CASE(
    "next to a lattice vertices of strained tissue have no higher frequency than the body has at rest") {
  World<double> reduced(stretched_bar()), exact(stretched_bar(RegionModel::nonlinear));
  StepLimit<double> estimate(edge);
  const double at_rest = 2 / exact.time_step_limit();
  double highest = 0, highest_exact = 0, most = 0;
  for (int i = 0; i < 40; ++i) {
    for (World<double>* each : {&reduced, &exact}) REQUIRE(each->advance(0.02).ok);
    if (i < 20) continue;  // while it is pulled it is stiffer at the end of a frame than at the start
    REQUIRE(region_of(reduced).any_embedded());
    highest = std::max(highest, estimate.highest_vertex(reduced.body()).omega);
    highest_exact = std::max(highest_exact, estimate.highest_vertex(exact.body()).omega);
    most = std::max(most, region_of(reduced).mass_added());
  }
  const double weight = reduced.elements().materials[0].density * total_volume(stretched_bar().mesh);
  MESSAGE("highest frequency of a vertex "
          << highest / at_rest << " of that of the body at rest, all non-linear " << highest_exact / at_rest
          << "; mass added " << most / weight);
  CHECK(highest_exact > 1.2 * at_rest);
  CHECK(highest < 1.01 * at_rest);
  CHECK(most < 0.3 * weight);
}

TEST_CASE("a free body in which strained vertices get mass keeps linear and angular momentum") {
  const Setup setup = bar(8, 4, false);
  World<double> world(setup);
  const Index v = vertices_near(setup.mesh, {0.08, 0.02, 0.02}, 0.012).front();
  world.apply(SetForces{{{v, Vec3d::Zero()}}});  // a zone around it, and no force
  State<double> state = world.state();
  for (Index i = 0; i < state.u.cols(); ++i) {
    const Vec3d X = setup.mesh.points.col(i);
    state.u.col(i) = 0.25 * X;
    state.v.col(i) = Vec3d(0.002, -0.004, 0.006) + Vec3d(0.02, 0.04, -0.06).cross(X);
  }
  world.set_state(state);
  REQUIRE_FALSE(region_of(world).embeds(v));
  world.step(1e-6);  // velocities are half a step behind from now on
  const double added = region_of(world).mass_added();
  const auto before = momentum_of(world);
  const std::vector<double> mass = world.body().inertia.mass();
  const Mat3X<double> velocity = world.body().motion.v.view();
  const Report report = world.advance(1e-5);
  REQUIRE(report.ok);
  double kinetic = 0;  // of vertices that got mass and kept their momentum
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (const double now = world.body().inertia.mass()[i]; now != mass[i])
      kinetic += mass[i] * velocity.col(Index(i)).squaredNorm() / 2 * (mass[i] / now - 1);
  CHECK(kinetic < 0);
  CHECK(report.transitions.kinetic == near(kinetic, 1e-9));
  const auto change = momentum_of(world) - before;
  CHECK(region_of(world).mass_added() > 1.01 * added);
  CHECK(change.linear.norm() < 1e-9 * before.linear.norm());
  CHECK(change.angular.norm() < 1e-6 * before.angular.norm());
}

TEST_CASE("slivers at a cut of a reduced body do not shorten its step") {
  const Setup setup = bar(16, 4);
  World<double> reduced(setup), exact(all_nonlinear(setup));
  const double at_rest = exact.time_step_limit();
  for (World<double>* each : {&reduced, &exact}) each->remove_tets(burnt(setup.mesh));
  REQUIRE(region_of(reduced).any_embedded());
  REQUIRE(region_of(reduced).tet_count() < reduced.elements().topology.alive_count());
  MESSAGE("limits " << reduced.time_step_limit() / at_rest << ", " << exact.time_step_limit() / at_rest
                    << " of that at rest");
  CHECK(exact.time_step_limit() < 0.95 * at_rest);
  CHECK(reduced.time_step_limit() > 0.98 * at_rest);
}

TEST_CASE("a world with mass of strained tissue goes on with the same bits from a checkpoint") {
  const Setup setup = stretched_bar();
  World<double> world(setup);
  const Folder folder;
  bool any_asked = false;
  for (int i = 0; i < 30; ++i) {
    REQUIRE(world.advance(0.02).ok);
    if (i % 5 != 4) continue;
    const Checkpoint<double> saved = world.save();
    for (double mass : saved.nodes.asked_mass) any_asked = any_asked || mass > 0;
    write_checkpoint(folder.path / "state", saved);
    World<double> restored(setup), back(setup);
    restored.restore(read_checkpoint<double>(folder.path / "state"));
    for (int k = 0; k < 3; ++k) CHECK(restored.advance(0.02).ok);
    restored.restore(saved);  // from a state in which nothing or other vertices are embedded or strained
    for (int k = 0; k < 2; ++k) {
      back.restore(saved);
      CHECK(back.advance(0.02).ok);
      CHECK(restored.advance(0.02).ok);
      CHECK(same_bits(back, restored));
      restored.restore(saved);
    }
    world = std::move(restored);
  }
  CHECK(any_asked);
}
