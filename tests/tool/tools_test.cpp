#include "lobe/tool/tools.h"

#include <doctest/doctest.h>

#include <cmath>

#include "condense/half_linear.h"
#include "folder.h"
#include "lobe/assert.h"
#include "lobe/error.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 0.02;  // [s]

Setup body(RegionModel model = RegionModel::tensor_mass) {
  Setup setup = half_linear(model);
  setup.damping = 15;
  return setup;
}

std::vector<Index> far_end(const Setup& setup) {
  std::vector<Index> vertices;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.045) vertices.push_back(v);
  return vertices;
}

Eigen::Vector4d turn_about_x(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3d::UnitX())).coeffs();
}

// What two hands do in the frames that are numbered so, by commands: pull, turn and wait, burn a line, let
// go.
template <class Hands>
void act(Hands& hands, const Setup& setup, int i) {
  constexpr ToolId grasp = 1, cautery = 2;
  if (i == 1) hands.apply(TakeHold{"left", far_end(setup)});
  if (i == 2) hands.apply(BringCautery{"right", 0.006, {0.06, 0.02, 0.05}});
  if (i >= 2 && i < 7) {
    const Vec3d centre(0.05, 0.025, 0.025);
    hands.apply(Lead{grasp, {centre + 0.001 * i * Vec3d(1, 1, 0.5), turn_about_x(0.05 * i)}});
  }
  if (i == 4) hands.apply(SwitchTool{cautery, true});
  if (i >= 4 && i < 9) hands.apply(Lead{cautery, {Vec3d(0.06 - 0.01 * (i - 3), 0.02, 0.05)}});
  if (i == 8) hands.apply(SwitchTool{cautery, false});
  if (i == 10) hands.apply(Lead{grasp, {Vec3d(0.055, 0.03, 0.025)}});
  if (i == 12) hands.apply(LetGo{grasp});
}

}  // namespace

TEST_CASE_TEMPLATE("what is done live, kept as paths of a setup, gives the same bits", Real, float, double) {
  for (RegionModel model : {RegionModel::tensor_mass, RegionModel::precomputed}) {
    const Setup setup = body(model);
    World<Real> live(setup);
    for (int i = 0; i < 16; ++i) {
      act(live, setup, i);
      REQUIRE(live.advance(frame).ok);
    }
    CHECK(live.elements().topology.alive_count() < live.elements().topology.tet_count() - 10);
    Setup kept = setup;
    static_cast<ToolSetups&>(kept) = live.tools().paths();
    REQUIRE(kept.grasps.size() == 1);
    REQUIRE(kept.cauteries.size() == 1);
    World<Real> again(kept, 2);
    for (int i = 0; i < 16; ++i) again.advance(frame);
    CHECK(same_bits(live, again));
  }
}

TEST_CASE("live tools are recorded, and go on with the same bits from a checkpoint") {
  const Setup setup = body();
  World<float> world(setup), restored(setup, 2);
  CommandRecorder<float> recorded(world);
  for (int i = 0; i < 16; ++i) {
    act(recorded, setup, i);
    if (i == 6) restored.restore(world.save());
    recorded.advance(frame);
    if (i == 6) restored.advance(frame);
    if (i > 6) {
      act(restored, setup, i);
      restored.advance(frame);
    }
  }
  CHECK(same_bits(world, restored));
  World<float> again(setup);
  CHECK(replay(recorded.recording(), again).same);
}

TEST_CASE(
    "tools that were taken away leave the lists, keep their paths, and come back with an earlier state") {
  const Setup setup = body();
  World<float> world(setup);
  Checkpoint<float> between;
  for (int i = 0; i < 20; ++i) {
    act(world, setup, i);
    if (i == 15) world.apply(LetGo{2});
    if (i == 10) between = world.save();
    REQUIRE(world.advance(frame).ok);
  }
  CHECK(world.tools().lists().grasps.empty());
  CHECK(world.tools().lists().cauteries.empty());
  REQUIRE(world.tools().grasp(1));
  CHECK(world.tools().grasp(1)->has_gone());
  CHECK(world.tools().paths().grasps.size() == 1);
  CHECK(world.tools().live_paths().cauteries.size() == 1);
  CHECK_THROWS_WITH_AS(world.apply(LetGo{1}), "tool 1: was let go already", InputError);
  CHECK_THROWS_WITH_AS(world.apply(LetGo{3}), "tool 3: is not there", InputError);

  const Folder folder;
  write_checkpoint(folder.path / "state", world.save());
  World<float> restored(setup, 2);
  restored.restore(read_checkpoint<float>(folder.path / "state"));
  CHECK(restored.tools().next_id() == 3);
  CHECK(restored.tools().lists().grasps.empty());
  world.advance(frame);
  restored.advance(frame);
  CHECK(same_bits(world, restored));

  world.restore(between);
  CHECK(world.tools().lists().grasps.size() == 1);
  for (int i = 10; i < 20; ++i) {
    act(world, setup, i);
    if (i == 15) world.apply(LetGo{2});
    REQUIRE(world.advance(frame).ok);
  }
  world.advance(frame);
  CHECK(same_bits(world, restored));
}

TEST_CASE(
    "a grasp moves and turns its vertices as a rigid body, from where it took hold to its pose at the "
    "frame's end") {
  const Setup setup = body();
  World<double> world(setup);
  const ToolId grasp = world.tools().next_id();
  world.apply(TakeHold{"hand", far_end(setup)});
  world.advance(frame);
  const Vec3d centre = world.tools().grasp(grasp)->centre, target = centre + Vec3d(0.003, -0.002, 0.001);
  Vec3d mean = Vec3d::Zero();
  for (Index v : far_end(setup)) mean += setup.mesh.points.col(v) / double(far_end(setup).size());
  CHECK((centre - mean).norm() < 1e-14);
  world.apply(Lead{grasp, {target, turn_about_x(0.3)}});
  world.advance(frame);
  const Mat3<double> R = Eigen::AngleAxisd(0.3, Vec3d::UnitX()).toRotationMatrix();
  const auto u = world.state().u;
  for (Index v : far_end(setup)) {
    const Vec3d X = setup.mesh.points.col(v);
    CHECK((X + u.col(v) - (target + R * (X - centre))).norm() < 1e-15);
  }
}

TEST_CASE("at rest the force of a grasp is its reaction, and its torque keeps the body's balance") {
  Setup setup = body(RegionModel::nonlinear);  // linear forces balance about where vertices rest
  setup.damping = 60;
  World<double> world(setup);
  const ToolId grasp = world.tools().next_id();
  world.apply(TakeHold{"hand", far_end(setup)});
  world.advance(frame);
  const Vec3d target = world.tools().grasp(grasp)->centre + Vec3d(0.004, 0.002, 0);
  world.apply(Lead{grasp, {target}});
  for (int i = 0; i < 300; ++i) world.advance(frame);
  const Grasp& held = *world.tools().grasp(grasp);
  const Vec3d reaction = world.body().reaction(grasp);
  CHECK(reaction.norm() > 0.01);
  CHECK((held.force - reaction).norm() < 1e-6 * reaction.norm());
  const Mat3X<double> f = world.forces();  // on vertices: those of the boundary balance the grasp's
  const auto u = world.state().u;
  Vec3d force = held.force, torque = held.torque;
  for (const HeldVertices::Held& item : world.held().all()) {
    if (item.holder != HeldVertices::boundary) continue;
    Vec3d own = -f.col(item.vertex);
    for (int axis = 0; axis < 3; ++axis)
      if (!item.axes[axis]) own[axis] = 0;
    const Vec3d x = setup.mesh.points.col(item.vertex) + u.col(item.vertex);
    force += own;
    torque += (x - target).cross(own);
  }
  CHECK(force.norm() < 1e-6 * reaction.norm());
  CHECK(torque.norm() < 1e-6 * 0.05 * reaction.norm());
}

TEST_CASE("with the implicit integrator too a grasp at rest feels its reaction") {
  Setup setup = body(RegionModel::nonlinear);
  setup.damping = 60;
  setup.integrator = Integrator::generalised_alpha;
  World<double> world(setup);
  world.apply(TakeHold{"hand", far_end(setup)});
  world.advance(frame);
  world.apply(Lead{1, {world.tools().grasp(1)->centre + Vec3d(0.004, 0.002, 0)}});
  for (int i = 0; i < 300; ++i) world.advance(frame);
  const Vec3d reaction = world.body().reaction(1);
  CHECK(reaction.norm() > 0.01);
  CHECK((world.tools().grasp(1)->force - reaction).norm() < 1e-6 * reaction.norm());
}

TEST_CASE("where a grasp takes hold or lets go within a frame, forces are means over the whole of it") {
  Setup setup = body();
  const std::vector<Index> end = far_end(setup);
  const auto push = [](double from, double to) {
    return std::vector<PathPoint>{{from, Vec3d::Zero()}, {to, Vec3d(0.001, 0, 0)}};
  };
  setup.grasps.push_back({"first", {end[0]}, push(0, frame / 2), true});
  setup.grasps.push_back({"second", {end[1]}, push(frame / 2, frame), false});
  World<double> whole(setup), halves(setup);
  whole.advance(frame);
  Vec3d force[2] = {Vec3d::Zero(), Vec3d::Zero()}, torque[2] = {Vec3d::Zero(), Vec3d::Zero()};
  for (int half = 0; half < 2; ++half) {
    halves.advance(frame / 2);
    for (ToolId id : {1, 2}) {
      force[id - 1] += halves.tools().grasp(id)->force / 2;
      torque[id - 1] += halves.tools().grasp(id)->torque / 2;
    }
  }
  CHECK(same_bits(whole, halves));
  for (ToolId id : {1, 2}) {
    const Grasp& grasp = *whole.tools().grasp(id);
    CHECK(grasp.force.norm() > 1e-4);
    CHECK((grasp.force - force[id - 1]).norm() < 1e-12 * grasp.force.norm());
    CHECK((grasp.torque - torque[id - 1]).norm() < 1e-12 * grasp.force.norm());
  }
  whole.advance(frame);
  CHECK(whole.tools().grasp(1)->force.norm() == 0);
}

TEST_CASE("a tool that is let go leaves the body to itself") {
  const Setup setup = body();
  World<double> world(setup);
  world.apply(TakeHold{"hand", far_end(setup)});
  world.advance(frame);
  const auto held = world.held().all().size();
  world.apply(LetGo{1});
  world.advance(frame);
  CHECK(world.held().all().size() == held - far_end(setup).size());
  CHECK(placed_tools(world).empty());
  CHECK_THROWS_WITH_AS(world.apply(Lead{1, {}}), "tool 1: was let go already", InputError);
}

TEST_CASE(
    "commands to tools that there are not, or with values that are none, are refused and change nothing") {
  Setup setup = body();
  setup.grasps.push_back({"scripted", {3}, {{0.5, Vec3d::Zero()}}, false});
  World<double> world(setup);
  CHECK_THROWS_WITH_AS(world.apply(Lead{7, {}}), "tool 7: is not there", InputError);
  CHECK_THROWS_WITH_AS(world.apply(Lead{1, {}}), "tool 1: follows the path of its scene", InputError);
  CHECK_THROWS_WITH_AS(world.apply(LetGo{1}), "tool 1: follows the path of its scene", InputError);
  CHECK_THROWS_AS(world.apply(TakeHold{"hand", {-1}}), InputError);
  CHECK_THROWS_AS(world.apply(TakeHold{"hand", {}}), InputError);
  CHECK_THROWS_AS(world.apply(BringCautery{"tip", 0, Vec3d::Zero()}), InputError);
  CHECK_THROWS_AS(world.apply(BringCautery{"tip", 0.01, Vec3d::Constant(std::nan(""))}), InputError);
  CHECK(world.tools().next_id() == 2);
  world.apply(TakeHold{"hand", {5}});
  CHECK_THROWS_AS(world.apply(Lead{2, {Vec3d::Constant(INFINITY)}}), InputError);
  CHECK_THROWS_AS(world.apply(Lead{2, {Vec3d::Zero(), Eigen::Vector4d::Zero()}}), InputError);
  CHECK(world.advance(frame).ok);
}

TEST_CASE("a path of a scene may turn a grasp, at a constant rate between its rows") {
  Setup setup = body();
  const std::vector<Index> end = far_end(setup);
  setup.grasps.push_back({"hand", end, {{0, Vec3d::Zero()}, {0.1, Vec3d::Zero(), turn_about_x(0.4)}}, false});
  World<double> world(setup);
  for (int i = 0; i < 5; ++i) {
    world.advance(0.02);
    const Mat3<double> R = Eigen::AngleAxisd(0.08 * (i + 1), Vec3d::UnitX()).toRotationMatrix();
    const Vec3d centre = world.tools().grasp(1)->centre;
    const auto u = world.state().u;
    for (Index v : end) {
      const Vec3d X = setup.mesh.points.col(v);
      CHECK((X + u.col(v) - (centre + R * (X - centre))).norm() < 1e-12);
    }
  }
}

TEST_CASE("a force or a cut of a tool that there never was is a fault of the library") {
  Tools tools{ToolSetups{}};
  tools.bring(BringProbe{});
  tools.begin_forces();
  OnTool felt;
  felt.tool = 1;
  CHECK_NOTHROW(tools.add_force(felt, 1e-3));
  for (const ToolId unknown : {0, 2, -1}) {
    felt.tool = unknown;
    CHECK_THROWS_AS(tools.add_force(felt, 1e-3), BrokenInvariant);
  }
  CHECK_THROWS_AS(tools.cut_by(1, {}, Vec3d::Zero(), Vec3d::Zero()), BrokenInvariant);  // it is no scalpel
}

TEST_CASE_TEMPLATE("a hook lifts by its core, burns when it is on, and gives the same bits as paths", Real,
                   float, double) {
  constexpr ToolId hook = 1;
  const Setup setup = body(RegionModel::nonlinear);
  const auto height = [&](World<Real>& world) {
    double sum = 0;
    for (const Index v : far_end(setup)) sum += double(world.displacements()(2, v));
    return sum / double(far_end(setup).size());
  };
  const Vec3d under(0.045, -0.01, -0.006);
  World<Real> live(setup);
  double lifted = 0, force = 0;
  for (int i = 0; i < 24; ++i) {
    if (i == 1) live.apply(BringCautery{"hook", 0.006, under, {0, 0.07, 0}, 0.004});
    if (i > 1 && i < 8) live.apply(Lead{hook, {under + Vec3d(0, 0, 0.001 * (i - 1))}});
    if (i == 16) lifted = height(live), force = live.tools().lists().cauteries.front().force[2];
    if (i == 16) live.apply(SwitchTool{hook, true});
    if (i == 18) live.apply(SwitchTool{hook, false});
    if (i == 20) live.apply(LetGo{hook});
    REQUIRE(live.advance(frame).ok);
    if (i < 16) CHECK(live.elements().topology.alive_count() == live.elements().topology.tet_count());
  }
  CHECK(lifted > 0.001);
  CHECK(lifted < 0.006);
  CHECK(force > 0);
  CHECK(live.elements().topology.alive_count() < live.elements().topology.tet_count());
  CHECK(live.tools().lists().cauteries.empty());
  Setup kept = setup;
  static_cast<ToolSetups&>(kept) = live.tools().paths();
  REQUIRE(kept.probes.size() == 1);
  REQUIRE(kept.cauteries.size() == 1);
  CHECK(kept.cauteries[0].core == 0);
  World<Real> played(kept);
  for (int i = 0; i < 24; ++i) REQUIRE(played.advance(frame).ok);
  CHECK(played.state().u == live.state().u);
}

TEST_CASE("a hook whose core is not thinner than its wire is refused") {
  Setup setup = body();
  setup.cauteries = {{"hook", 0.0011, {{0, Vec3d::Zero()}}, {0, 0.07, 0}, 0.0011}};
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("a core of at least 0 m that is thinner"),
                       InputError);
  World<double> world(body());
  for (const double core : {0.001, -0.001})
    CHECK_THROWS_AS(world.apply(BringCautery{"hook", 0.001, Vec3d::Zero(), Vec3d::Zero(), core}), InputError);
}
