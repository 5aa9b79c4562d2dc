// Parts at rest sleep: what that costs in accuracy, what it saves, and what wakes them.
#include "lobe/time/sleep.h"

#include <doctest/doctest.h>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/world.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame_length = 0.02;  // [s]

// Half linear, half non-linear; its upper end is held, its weight acts from the start.
Setup hanging_bar(double tolerance) {
  Setup setup = setup_of(box_mesh({0.03, 0.03, 0.3}, 4, 4, 40));  // 3,840 tetrahedra
  setup.volume_penalty = 1e5;
  setup.damping = 20;
  setup.gravity = {0, 0, -9.81};
  setup.sleep = tolerance;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() > 0.15) setup.region_of[t] = RegionModel::tensor_mass;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > 0.299) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

void grasp_lower_end(Setup& setup, const std::vector<PathPoint>& path) {
  GraspSetup grasp{"grasp", {}, path, true};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.001) grasp.vertices.push_back(v);
  setup.grasps.push_back(grasp);
}

// Pulled aside, kept there, let go.
Setup pulled_bar(double tolerance) {
  Setup setup = hanging_bar(tolerance);
  grasp_lower_end(setup, {{0.2, {0, 0, 0}}, {0.4, {0.015, 0, 0}}, {1.8, {0.015, 0, 0}}});
  return setup;
}

std::vector<Index> notch(const Setup& setup) {
  std::vector<Index> tets;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (const Vec3d x = barycentre(setup.mesh, t); x.x() < 0.02 && std::abs(x.z() - 0.1) < 0.004)
      tets.push_back(t);
  return tets;
}

template <class Real>
double largest_difference(World<Real>& a, World<Real>& b) {  // [m]
  double largest = 0;
  for (Index v = 0; v < a.elements().topology.vertex_count(); ++v)
    if (!a.elements().topology.around(v).empty())
      largest = std::max(largest, double((a.state().u.col(v) - b.state().u.col(v)).norm()));
  return largest;
}

// Until everything sleeps.
template <class Real>
void settle(World<Real>& world) {
  for (int i = 0; i < 300 && world.body().sleep.count() < world.elements().topology.vertex_count(); ++i)
    world.advance(frame_length);
  REQUIRE(world.body().sleep.count() == world.elements().topology.vertex_count());
}

}  // namespace

TEST_CASE_TEMPLATE("a run whose parts sleep stays within 1e-3 of the full one through pull, cut and release",
                   Real, float, double) {
  constexpr double largest = 0.015, tolerance = 1e-3 * largest;
  World<Real> full(pulled_bar(0)), run(pulled_bar(tolerance));
  const std::vector<Index> tets = notch(pulled_bar(0));
  int fully_asleep = 0, partly = 0, awake = 0;
  for (int i = 0; i < 170; ++i) {
    if (i == 75) CHECK(full.remove_tets(tets) == run.remove_tets(tets));
    CHECK(full.advance(frame_length).patches_skipped == 0);
    const Report report = run.advance(frame_length);
    REQUIRE(report.ok);
    (report.patches_evaluated == 0 ? fully_asleep : report.patches_skipped > 0 ? partly : awake) += 1;
    CHECK(largest_difference(run, full) < tolerance);
  }
  CHECK(double(full.state().u.cwiseAbs().maxCoeff()) > 0.9 * largest);
  CHECK(fully_asleep > 5);
  CHECK(partly > 3);
  CHECK(awake > 50);
}

TEST_CASE("a slow pull is followed within the tolerance") {
  Setup setup = hanging_bar(0);
  grasp_lower_end(setup, {{1, {0, 0, 0}}, {4, {0.0003, 0, 0}}});  // 0.1 mm/s
  World<double> full(setup);
  setup.sleep = 2e-5;
  World<double> run(setup);
  int partly = 0;
  for (int i = 0; i < 200; ++i) {
    full.advance(frame_length);
    run.advance(frame_length);
    if (i > 75) partly += run.body().sleep.count() > 0;
    CHECK(largest_difference(run, full) < setup.sleep);
  }
  CHECK(partly > 10);
}

TEST_CASE("a body at rest is not evaluated at all, and a cut wakes what is beside it alone") {
  Setup setup = hanging_bar(1e-5);
  setup.gravity.setZero();
  World<float> world(setup);
  settle(world);
  const Report rest = world.advance(frame_length);
  CHECK(rest.steps > 5);
  CHECK(rest.patches_evaluated == 0);
  CHECK(rest.patches_skipped > rest.steps);
  CHECK(world.remove_tets(notch(setup)) > 0);
  const Report cut = world.advance(frame_length);
  CHECK(world.body().sleep.count() > 0);
  CHECK(world.body().sleep.count() < world.elements().topology.vertex_count());
  CHECK(cut.patches_evaluated > cut.steps);
  CHECK(cut.patches_skipped > cut.steps);
}

TEST_CASE_TEMPLATE("forces that are kept equal those found anew, to the bit", Real, float, double) {
  World<Real> world(pulled_bar(2e-5));
  for (int i = 0; i < 300 && world.body().sleep.count() == 0; ++i) world.advance(frame_length);
  REQUIRE(world.body().sleep.count() > 0);
  for (int i = 0; i < 10; ++i) {
    world.step(0.2 * world.time_step_limit());
    const Mat3X<Real> kept = world.forces();
    World<Real> awake(pulled_bar(0));
    awake.set_state(world.state());
    CHECK(kept == Mat3X<Real>(awake.forces()));
  }
}

TEST_CASE("who sleeps depends neither on threads nor on a checkpoint in between") {
  const Setup setup = pulled_bar(2e-5);
  World<float> one(setup), two(setup, 2), seven(setup, 7);
  const Folder folder;
  bool mixed = false;
  for (int i = 0; i < 90; ++i) {
    one.advance(frame_length);
    two.advance(frame_length);
    seven.advance(frame_length);
    REQUIRE(same_bits(one, two));
    REQUIRE(same_bits(one, seven));
    if (mixed || one.body().sleep.count() == 0) continue;
    mixed = one.body().sleep.count() <
            setup.mesh.vertex_count();  // from here on, one is a world restored from a file
    write_checkpoint(folder.path / "state", one.save());
    one = World<float>(setup);
    one.restore(read_checkpoint<float>(folder.path / "state"));
    CHECK(one.body().sleep.count() == two.body().sleep.count());
  }
  CHECK(mixed);
}

TEST_CASE(
    "a world in which some sleep has the same bits when it is restored between two searches of the limit") {
  const Setup setup = pulled_bar(2e-5);
  World<float> world(setup), restored(setup);
  const auto is_mixed = [&] {
    const Index asleep = world.body().sleep.count();
    return asleep > 0 && asleep < setup.mesh.vertex_count();
  };
  for (int i = 0; i < 90 && !is_mixed(); ++i) world.advance(frame_length);
  REQUIRE(is_mixed());
  for (int i = 0; i < 40; ++i) {
    if (i % 7 == 0) restored.restore(world.save());
    world.advance(0.001);
    restored.advance(0.001);
    REQUIRE(same_bits(world, restored));
  }
}

TEST_CASE("who sleeps wakes when the state is set or a tool moves what it holds") {
  Setup setup = hanging_bar(2e-5);
  grasp_lower_end(setup, {{0.0, {0, 0, 0}}, {3.99, {0, 0, 0}}, {4.2, {0, 0, 0.01}}});
  World<double> world(setup);
  while (world.time() < 3.9) world.advance(frame_length);
  CHECK(world.body().sleep.count() == setup.mesh.vertex_count());
  const State<double> rest = world.state();
  State<double> moved = rest;
  moved.u += random_displacement(setup.mesh.vertex_count(), 1e-4);
  world.set_state(moved);
  CHECK(world.body().sleep.count() == 0);
  setup.sleep = 0;
  World<double> awake(setup);
  awake.set_state(moved);
  CHECK(Mat3X<double>(world.forces()) == Mat3X<double>(awake.forces()));
  world.set_state(rest);
  while (world.time() < 3.99) world.advance(frame_length);
  while (world.time() < 4.1) world.advance(frame_length);
  CHECK(world.body().sleep.count() == 0);
  CHECK(world.state().v.norm() > 0);
}

TEST_CASE("a body whose vertices are partly held, or on a precomputed region, sleeps as a whole") {
  Setup setup = hanging_bar(2e-5);
  for (RegionModel& model : setup.region_of)
    if (model == RegionModel::tensor_mass) model = RegionModel::precomputed;
  setup.prescribed.push_back({0, Vec3d::Zero(), {true, false, false}});
  World<float> world(setup);
  Report report;
  for (int i = 0; i < 200 && (report.steps == 0 || report.patches_evaluated > 0); ++i)
    report = world.advance(frame_length);
  CHECK(report.patches_evaluated == 0);
  CHECK(world.state().v.isZero(0));
}

TEST_CASE("sleep is refused where forces depend on more than a patch's own vertices, or steps are implicit") {
  Setup implicit = hanging_bar(1e-5);
  implicit.integrator = Integrator::generalised_alpha;
  CHECK_THROWS_WITH_AS(World<double>{implicit},
                       doctest::Contains("\"sleep\" does not go with \"integrator\": \"implicit\""),
                       InputError);
  CHECK_THROWS_WITH_AS(World<double>{averaged(hanging_bar(1e-5))}, doctest::Contains("sleep"), InputError);
  CHECK_THROWS_WITH_AS(World<double>{hanging_bar(-1)}, doctest::Contains("sleep must be"), InputError);
}
