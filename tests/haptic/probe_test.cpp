// A probe in a haptic hand.
#include "benchmarks/haptic_touch.h"
#include "haptic/standing_block.h"
#include "haptic/virtual_loop.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a probe pushes and is pushed back; in the air, before and after, it feels nothing") {
  constexpr double radius = 0.008, gap = 0.004;
  struct Tool {
    RigidShape shape;
    double above;  // the face that it touches with [m]
  };
  // Jaws go upwards from their position, shut.
  const Tool ball{RigidShape::sphere(radius), radius}, jaws{RigidShape::jaws({0.012, 0.006, 0.02}), 0};
  for (const auto& [tool, frame] :
       {std::pair(ball, 1e-3), {ball, 1.0 / 120}, {jaws, 1e-3}, {jaws, 1.0 / 120}}) {
    CAPTURE(tool.above);
    CAPTURE(frame);
    const bench::HandPath path{{{Vec3d::Zero(), 0, 0.3},
                                {{0, 0, -0.010}, 0.05},
                                {Vec3d::Zero(), 0, 0.2},
                                {Vec3d::Zero(), 0.05},
                                {Vec3d::Zero(), 0, 0.3}}};
    VirtualLoop loop(
        block(), [path](double time) -> Vec3d { return path.at(time); }, frame);
    const Vec3d tip = top + Vec3d(0, 0, tool.above + gap);
    loop.controller.send(bring_tool(1, tip, BringProbe{"", tool.shape, {.position = tip}, 0.1}));
    double highest = 0, lowest = 0, jump = 0;
    Vec3d before = Vec3d::Zero();
    loop.run(0.3, [&](const HapticState& state) { CHECK(state.force.norm() < 0.02); });
    loop.run(1.0, [&](const HapticState& state) {
      highest = std::max(highest, state.force.z());
      lowest = std::min(lowest, state.force.z());
      jump = std::max(jump, (state.force - before).norm());
      before = state.force;
    });
    MESSAGE("largest jump " << jump << " N of " << highest << " N");
    CHECK(jump < 0.2 * highest);
    CHECK(loop.servo().state().limited == 0);
    CHECK(highest > 0.1);
    CHECK(lowest > -0.02);  // it is never drawn
    loop.run(0.3, [](const HapticState&) {});
    CHECK(loop.servo().state().force.norm() < 0.02);
    CHECK(replays(loop.session, loop.setup));
  }
}

// At 20 Hz some comes out (docs/haptics.md, Passivity).
TEST_CASE("over presses with a probe no energy comes out") {
  struct Press {
    double frame, depth, speed;  // [s], [m], [m/s]
  };
  std::vector<Press> presses;
  for (double frame : {1e-3, 1.0 / 120, 1.0 / 60, 1.0 / 20})
    for (const auto& [depth, speed] : {std::pair(0.008, 0.1), {0.005, 0.1}, {0.008, 0.05}})
      presses.push_back({frame, depth, speed});
  for (const auto& [frame, depth, speed] : presses) {
    CAPTURE(frame);
    CAPTURE(depth);
    CAPTURE(speed);
    const bench::HandPath path{{{Vec3d::Zero(), 0, 0.2},
                                {(approach + depth) * downwards, speed},
                                {Vec3d::Zero(), 0, 0.3},
                                {Vec3d::Zero(), speed},
                                {Vec3d::Zero(), 0, 0.3}}};
    VirtualLoop loop(
        standing_block(), [path](double time) -> Vec3d { return path.at(time); }, frame);
    const bench::Sphere sphere = bench::sphere_before(loop.setup, {0.025, 0.025, 0.04}, downwards, approach);
    loop.controller.send(bring_tool(
        1, sphere.start, BringProbe{"", RigidShape::sphere(sphere.radius), {.position = sphere.start}, 0}));
    const auto [given, stored] = loop.energy_over(path.duration() + 0.05);
    MESSAGE("energy given to the hand " << 100 * given / stored << " % of the " << 1e3 * stored
                                        << " mJ stored, " << loop.servo().state().interventions
                                        << " interventions");
    CHECK(stored > 4e-4);
    CHECK(given <= (frame > 0.02 ? 0.2 : frame > 0.01 ? 0.05 : 0.0) * stored);
    if (frame < 0.01) CHECK(loop.servo().state().interventions == 0);
  }
}
