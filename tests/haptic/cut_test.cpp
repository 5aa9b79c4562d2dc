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
  std::uint64_t limited = 0;  // ticks in which it was cut off
  std::uint64_t interventions = 0;
};

// Down by 6 mm, with what it holds or after the approach of a sphere, held there for 0.3 s, and back.
Press press(bool holds, Cutter cutter, double frame) {
  Setup setup = standing_block();
  cut_with(cutter, setup);
  const Vec3d down = (holds ? 0.006 : approach + 0.008) * downwards;
  const HandPath path{{{Vec3d::Zero(), 0, 0.2},
                       {down, 0.1},
                       {Vec3d::Zero(), 0, 0.3},
                       {Vec3d::Zero(), 0.1},
                       {Vec3d::Zero(), 0, 0.1}}};
  VirtualLoop loop(
      setup, [path](double time) -> Vec3d { return path.at(time); }, frame);
  if (holds) {
    loop.take_hold();
  } else {
    const Sphere sphere = sphere_before(setup, {0.025, 0.025, 0.04}, downwards, approach);
    loop.controller.send(bring_tool(
        1, sphere.start, BringProbe{"", RigidShape::sphere(sphere.radius), {.position = sphere.start}, 0}));
  }
  Press felt;
  Vec3d before = Vec3d::Zero();
  loop.run(1.0, [&](const HapticState& state) {
    felt.peak = std::max(felt.peak, state.force.norm());
    felt.step = std::max(felt.step, (state.force - before).norm());
    before = state.force;
  });
  felt.limited = loop.servo().state().limited;
  felt.interventions = loop.servo().state().interventions;
  return felt;
}

}  // namespace

// In frames of 1 ms the body itself answers the hand: what changes there from tick to tick is not the local
// model's doing. A cut makes that force jump. The device bears 0.2 N per tick.
TEST_CASE(
    "a cut near a tool makes the force jump little more than in frames of 1 ms, and nothing is cut off") {
  for (const bool holds : {true, false}) {
    CAPTURE(holds);
    const Press whole = press(holds, Cutter::none, 1e-3);
    for (const Cutter cutter : {Cutter::cautery, Cutter::blade}) {
      const bool burns = cutter == Cutter::cautery;
      CAPTURE(burns);
      const Press exact = press(holds, cutter, 1e-3), felt = press(holds, cutter, 1.0 / 120);
      MESSAGE("largest change per tick: " << 1e3 * whole.step << " mN uncut, " << 1e3 * exact.step
                                          << " mN cut, " << 1e3 * felt.step
                                          << " mN in frames of 1/120 s; peak " << exact.peak << " N");
      CHECK(exact.peak > 1);
      CHECK(exact.step > whole.step + 0.02 * exact.peak);  // the body's force jumps by itself
      CHECK(felt.step <= 1.5 * exact.step);
      CHECK(felt.step <= 0.15);
      CHECK(felt.limited == 0);
      CHECK(felt.interventions == 0);
    }
  }
}
