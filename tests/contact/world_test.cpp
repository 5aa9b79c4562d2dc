// Contact beside what else a world does: precomputed regions, selective masses, sleep, cuts.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "contact/frame.h"
#include "lobe/contact/contact.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Held at the bottom; its lower part may be of another model.
Setup block(RegionModel lower, RegionModel upper, const TetMesh& mesh = irregular_box(5)) {
  Setup setup = setup_of(mesh, upper);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() < 0.02) setup.region_of[std::size_t(t)] = lower;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 15;
  return setup;
}

ProbeSetup from_above(std::vector<PathPoint> path) {
  return {"ball", RigidShape::sphere(0.012), 0.1, std::move(path)};
}

// Comes down by 3 mm, stays, goes up again.
std::vector<PathPoint> press_and_leave() {
  return {{0, {0.025, 0.024, 0.068}},
          {0.1, {0.025, 0.024, 0.058}},
          {0.3, {0.025, 0.024, 0.058}},
          {0.4, {0.025, 0.024, 0.1}}};
}

const Probe& ball(World<float>& world) { return world.tools().lists().probes.front(); }

}  // namespace

TEST_CASE("a precomputed region is expanded while a probe may press on it, and condensed again afterwards") {
  Setup setup = block(RegionModel::precomputed, RegionModel::precomputed);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() < 0.02) setup.region_of[std::size_t(t)] = RegionModel::nonlinear;
  setup.expandable = true;
  setup.probes.push_back(from_above(press_and_leave()));
  World<float> world(setup), restored(setup, 2);
  double most = 0;
  std::vector<int> expanded;
  for (int i = 0; i < 60; ++i) {
    if (i == 12) restored.restore(world.save());
    REQUIRE(world.advance(frame).ok);
    if (i >= 12) restored.advance(frame);
    most = std::max(most, ball(world).force.norm());
    expanded.push_back(world.body().regions.is_expanded());
  }
  CHECK(most > 0.05);
  CHECK(expanded[8]);
  CHECK(expanded[25]);
  CHECK_FALSE(expanded.back());
  CHECK(same_bits(world, restored));

  setup.expandable = false;
  World<float> cannot(setup);
  std::string said;
  for (int i = 0; i < 8; ++i)
    for (const Condition& condition : cannot.advance(frame).conditions) said += condition.text;
  CHECK(said.find("precomputed region, has no effect") != std::string::npos);
}

// Recovering the interior, as whoever looks at it does, is none of contact's business.
TEST_CASE("a world that nobody looks at has the same bits beside a precomputed region that is touched") {
  Setup setup = block(RegionModel::precomputed, RegionModel::precomputed);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() < 0.02) setup.region_of[std::size_t(t)] = RegionModel::nonlinear;
  setup.gravity = {3, 0, -9.81};
  setup.probes.push_back(
      from_above({{0, {0.02, 0.024, 0.068}}, {0.05, {0.02, 0.024, 0.056}}, {0.3, {0.04, 0.024, 0.056}}}));
  World<float> seen(setup), unseen(setup, 2);
  for (World<float>* world : {&seen, &unseen})
    for (int i = 0; i < 25; ++i) {
      if (i == 12) {
        SetRegion freed{{}, RegionModel::nonlinear};
        for (Index t = 0; t < setup.mesh.tet_count(); ++t) freed.tets.push_back(t);
        world->apply(freed);
      }
      REQUIRE(world->advance(frame).ok);
      if (world == &seen) world->state();
    }
  CHECK(ball(seen).force.norm() > 0.01);
  CHECK(same_bits(seen, unseen));
}

// On a mesh of 750 tetrahedra forces differ by 18 %, since the one contact follows flat triangles more
// closely than the other; and both are twice that of a fine mesh.
TEST_CASE("with selective masses contact leaves the step alone, and the probe feels the same at rest") {
  Setup setup = block(RegionModel::nonlinear, RegionModel::nonlinear, refine(irregular_box(5)).mesh);
  setup.probes.push_back(from_above({{0, {0.025, 0.024, 0.063}}, {0.2, {0.025, 0.024, 0.059}}}));
  World<float> lumped(setup);
  setup.selective_mass = 5;
  World<float> selective(setup);
  const double limit = selective.time_step_limit();
  Report last;
  for (int i = 0; i < 30; ++i) {
    REQUIRE(lumped.advance(frame).ok);
    last = selective.advance(frame);
    REQUIRE(last.ok);
    CHECK(last.reruns == 0);
  }
  MESSAGE("force " << ball(lumped).force.z() << " N, with selective masses " << ball(selective).force.z()
                   << " N; limit " << last.time_step_limit / limit);
  CHECK(ball(selective).force.z() == near(ball(lumped).force.z(), 0.08));
  CHECK(last.time_step_limit > 0.99 * limit);
}

TEST_CASE("who sleeps wakes where a probe comes") {
  Setup setup = block(RegionModel::nonlinear, RegionModel::nonlinear);
  setup.sleep = 1e-6;
  setup.probes.push_back(
      from_above({{0, {0.025, 0.024, 0.2}}, {1, {0.025, 0.024, 0.2}}, {1.2, {0.025, 0.024, 0.058}}}));
  World<float> world(setup);
  for (int i = 0; i < 45; ++i) REQUIRE(world.advance(frame).ok);
  REQUIRE(world.body().sleep.any());
  for (int i = 0; i < 17; ++i) REQUIRE(world.advance(frame).ok);
  Setup awake = setup;
  awake.sleep = 0;
  World<float> other(awake);
  for (int i = 0; i < 62; ++i) other.advance(frame);
  CHECK(ball(other).force.norm() > 0.05);
  CHECK(ball(world).force.norm() == near(ball(other).force.norm(), 0.02));
}

TEST_CASE("contact follows cuts: it is that of a body built afresh") {
  Setup setup = block(RegionModel::tensor_mass, RegionModel::nonlinear);
  setup.probes.push_back(from_above(press_and_leave()));
  World<double> world(setup);
  for (int i = 0; i < 8; ++i) REQUIRE(world.advance(frame).ok);
  std::vector<Index> pit;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if ((barycentre(setup.mesh, t) - Vec3d(0.036, 0.024, 0.05)).norm() < 0.011) pit.push_back(t);
  REQUIRE(world.remove_tets(pit) > 5);
  world.step(1e-9);
  CompactMesh compacted;
  Setup cut = world.current_setup(compacted);
  cut.probes = setup.probes;
  World<double> fresh(cut);
  State<double> state = world.state(), there = fresh.state();
  REQUIRE(there.u.cols() < state.u.cols() + 1);
  for (Index v = 0; v < state.u.cols(); ++v) {
    const Index target = compacted.vertex_target[std::size_t(v)];
    if (target >= 0) there.u.col(target) = state.u.col(v);
  }
  there.time = state.time;
  fresh.set_state(there);
  fresh.step(1e-9);
  const auto force_of = [](World<double>& simulated) {
    Mat3X<double> f = Mat3X<double>::Zero(3, simulated.state().u.cols());
    simulated.body().terms.front()->add_forces(simulated.body().here(), f);
    return f;
  };
  const auto pressures = [](World<double>& own) {
    return dynamic_cast<const Contact<double>&>(*own.body().terms.front()).surface();
  };
  CHECK(pressures(world).triangles().size() == pressures(fresh).triangles().size());
  const Mat3X<double> f = force_of(world), expected = force_of(fresh);
  REQUIRE(expected.norm() > 1e-3);
  // Stiffness depends on ω_max at rest, which a world measures when it is built.
  const double scale = std::pow(pressures(world).omega() / pressures(fresh).omega(), 2);
  CHECK(scale == near(1, 0.1));
  CHECK(f.rowwise().sum().norm() == near(expected.rowwise().sum().norm(), 0.1));
}

TEST_CASE(
    "a pressure of 10 kPa goes at most 0.6 mm deep on a liver, 1 mm with smoothed tetrahedra, in the "
    "median") {
  const auto path = std::filesystem::path(LOBE_DATA_DIR) / "meshes" / "liver_10k.vtu";
  const TetMesh mesh = read_mesh(path).mesh;
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed}) {
    Setup setup = setup_of(mesh, RegionModel::nonlinear);
    setup.materials[0].element = element;
    setup.probes.push_back(from_above({{0, {0, 0, 1}}}));
    World<float> world(setup);
    REQUIRE(world.advance(1e-3).ok);
    std::vector<double> depths;  // [m]
    for (const auto& triangle :
         dynamic_cast<const Contact<float>&>(*world.body().terms.front()).surface().triangles())
      depths.push_back(1e4 / triangle.stiffness);
    std::sort(depths.begin(), depths.end());
    const double median = depths[depths.size() / 2], high = depths[depths.size() * 95 / 100];
    MESSAGE("depth at 10 kPa " << 1e3 * median << " mm, 95 % quantile " << 1e3 * high << " mm");
    CHECK(median <= (element == ElementType::tetrahedron ? 0.6e-3 : 1e-3));  // by its lower frequencies
    CHECK(median > 0.1e-3);
  }
}
