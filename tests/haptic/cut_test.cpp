// Tissue near a tool in a haptic hand is cut while the tool presses on it.
#include "benchmarks/haptic_touch.h"
#include "haptic/standing_block.h"
#include "haptic/virtual_loop.h"

using namespace lobe;
using namespace lobe::test;
using namespace lobe::bench;

namespace {

enum class Cutter : std::uint8_t { none, cautery, blade };

// While the tool presses, a cautery burns its way through the block below it, or a blade comes down beside
// it.
void cut_with(Cutter cutter, Setup& setup) {
  constexpr double from = 1.25, to = 1.6;  // [s]
  if (cutter == Cutter::cautery) {
    setup.cauteries.push_back(
        {"cautery", 0.005, {{from, {-0.01, 0.025, 0.028}}, {to, {0.06, 0.025, 0.028}}}});
  } else if (cutter == Cutter::blade) {
    ScalpelSetup blade;
    blade.name = "blade";
    blade.path = {{from, {0.034, -0.01, 0.06}}, {to, {0.034, -0.01, 0.015}}};
    blade.heels = {{0.034, 0.06, 0.06}, {0.034, 0.06, 0.015}};
    setup.scalpels.push_back(blade);
  }
}

struct Press {
  double peak = 0, step = 0;  // of the force on the hand, and of its change between two ticks [N]
  double body = 0;            // the largest change of the body's force between two frames [N]
  std::uint64_t limited = 0;  // ticks in which it was cut off
  std::uint64_t interventions = 0;
};

// Down by 6 mm, with what it holds or after the approach of a sphere, held there, and back.
HandPath way(bool holds, double rest) {
  const Vec3d down = (holds ? 0.006 : approach + 0.008) * downwards;
  return {{{Vec3d::Zero(), 0, 0.2},
           {down, 0.1},
           {Vec3d::Zero(), 0, rest},
           {Vec3d::Zero(), 0.1},
           {Vec3d::Zero(), 0, 0.1}}};
}

void take(VirtualLoop& loop, bool holds) {
  if (holds) return loop.take_hold();
  const Sphere sphere = sphere_before(loop.setup, {0.025, 0.025, 0.04}, downwards, approach);
  loop.controller.send(bring_tool(
      1, sphere.start, BringProbe{"", RigidShape::sphere(sphere.radius), {.position = sphere.start}, 0}));
}

Press press(bool holds, Cutter cutter, double frame) {
  Setup setup = standing_block();
  cut_with(cutter, setup);
  const HandPath path = way(holds, 0.3);
  VirtualLoop loop(
      setup, [path](double time) -> Vec3d { return path.at(time); }, frame);
  take(loop, holds);
  Press felt;
  Vec3d before = Vec3d::Zero(), of_body = Vec3d::Zero();
  loop.run(1.0, [&](const HapticState& state) {
    felt.peak = std::max(felt.peak, state.force.norm());
    felt.step = std::max(felt.step, (state.force - before).norm());
    before = state.force;
    const Vec3d now = loop.link.model.latest()->force;
    felt.body = std::max(felt.body, (now - of_body).norm());
    of_body = now;
  });
  felt.limited = loop.servo().state().limited;
  felt.interventions = loop.servo().state().interventions;
  return felt;
}

}  // namespace

// In frames of 1 ms the body itself answers the hand: what changes there from tick to tick is not the local
// model's doing. A cut makes that force jump. In frames of 1/120 s the hand does not feel that: the model is
// blended over 4 ms.
TEST_CASE(
    "a cut near a tool makes the force jump by little more than the press does, and nothing is cut off") {
  for (const bool holds : {true, false}) {
    CAPTURE(holds);
    const Press whole = press(holds, Cutter::none, 1e-3), uncut = press(holds, Cutter::none, 1.0 / 120);
    for (const Cutter cutter : {Cutter::cautery, Cutter::blade}) {
      const bool burns = cutter == Cutter::cautery;
      CAPTURE(burns);
      const Press exact = press(holds, cutter, 1e-3), felt = press(holds, cutter, 1.0 / 120);
      MESSAGE("largest change per tick: "
              << 1e3 * uncut.step << " mN uncut, " << 1e3 * felt.step << " mN cut; in frames of 1 ms "
              << 1e3 * whole.step << " and " << 1e3 * exact.step << " mN, of the body itself "
              << 1e3 * whole.body << " and " << 1e3 * exact.body << " mN; peak " << exact.peak << " N");
      CHECK(exact.peak > 1);
      CHECK(exact.body > whole.body + 0.02 * exact.peak);  // it jumps by itself
      CHECK(felt.step <= 1.1 * uncut.step);
      CHECK(exact.step <= 0.15);
      for (const Press& each : {exact, felt}) {
        CHECK(each.limited == 0);
        CHECK(each.interventions == 0);
      }
    }
  }
}

// The layer below the tool is gone at once. What is loose is held by nothing but the hand.
TEST_CASE("what is cut loose in a hand hardly draws it, and a sphere that touches it never does") {
  for (const double frame : {1e-3, 1.0 / 120})
    for (const bool holds : {true, false}) {
      CAPTURE(frame);
      CAPTURE(holds);
      const HandPath path = way(holds, 0.8);
      VirtualLoop loop(
          standing_block(), [path](double time) -> Vec3d { return path.at(time); }, frame);
      take(loop, holds);
      loop.run(0.55, [](const HapticState&) {});
      const double whole = loop.servo().state().force.z();
      const HapticState before = loop.servo().state();
      RemoveTets cut;
      for (Index t = 0; t < loop.setup.mesh.tet_count(); ++t)
        if (std::abs(barycentre(loop.setup.mesh, t).z() - 0.035) < 0.006) cut.tets.push_back(t);
      loop.controller.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(cut)});
      double lowest = whole, highest = whole, drawn = 0;
      loop.run(0.3, [&](const HapticState& state) {
        const double normal = holds ? state.force.z() : loop.link.model.latest()->normal.dot(state.force);
        lowest = std::min(lowest, normal);
        highest = std::max(highest, normal);
        // The coupling has a quarter of the device's damping of 0.5 N s/m.
        drawn = std::max(drawn, -normal - 0.125 * state.device.velocity.norm());
      });
      MESSAGE("force from " << lowest << " to " << highest << " N, drawn by " << drawn << " N; limited "
                            << loop.servo().state().limited - before.limited);
      CHECK(whole > 0.9);
      CHECK(highest < 1.02 * whole);
      CHECK(lowest > (holds ? -0.25 * whole : -0.01));
      if (!holds) CHECK(drawn < 1e-9);
      CHECK(loop.servo().state().interventions == before.interventions);
    }
}
