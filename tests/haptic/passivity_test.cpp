#include "lobe/haptic/passivity.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "lobe/haptic/devices.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double period = 1e-3;  // of the loop [s]

struct Played {
  double first = 0, last = 0, highest = 0;  // energy of hand and springs, of the first and the last tenth [J]
  std::uint64_t interventions = 0;
};

// A device that nobody holds swings against a wall that holds it, of the coupling's stiffness nearly.
Played swing(double share_of_bound, double highest_damping) {
  const SimulatedHand::Mechanics mechanics{.mass = 0.1, .damping = 0.5, .grip = 0, .grip_damping = 0};
  SimulatedHand hand(
      mechanics, [](double) { return Vec3d(0, 0, 0); }, period);
  DeviceLimits limits = hand.limits();
  limits.force = limits.slew = 1e9;
  limits.stiffness = 1e9;
  Servo servo(limits,
              {.bound_share = share_of_bound, .coupling_damping = 0, .highest_damping = highest_damping});
  LocalModel wall{.is_engaged = true, .engagement = 1};
  wall.K = 1e9 * Mat3<double>::Identity();  // the coupling is all that yields
  const double K = servo.state().coupling;
  Played played;
  constexpr int begin = 60, ticks = 3000 + begin;  // until the force has faded in
  for (int i = 0; i < ticks; ++i) {
    DeviceState device;
    hand.read(device);
    wall.time += 1e-6;
    const bool is_pushed = i >= begin && i < begin + 20;  // a knock
    const HapticState& state = servo.tick(&device, wall, period);
    hand.write(is_pushed ? Vec3d(1, 0, 0) : state.force, Vec3d::Zero());
    const double energy = hand.energy() + 0.5 * K * device.position.squaredNorm();
    if (i >= begin + 20 && i < begin + 20 + ticks / 10) played.first = std::max(played.first, energy);
    if (i >= ticks - ticks / 10) played.last = std::max(played.last, energy);
    played.highest = std::max(played.highest, energy);
  }
  played.interventions = servo.state().interventions;
  return played;
}

}  // namespace

TEST_CASE("Colgate's bound") {
  CHECK(passive_stiffness(0.5, 0.1, 1e-3) == near(800, 1e-12));
  CHECK(passive_stiffness(0.5, -0.1, 1e-3) == near(800, 1e-12));
  CHECK(passive_stiffness(0.1, 0.5, 1e-3) == 0);
}

TEST_CASE("below the bound a knocked device comes to rest, and the controller has nothing to do") {
  const Played played = swing(0.8, 5);
  CHECK(played.last < 0.5 * played.first);
  CHECK(played.interventions == 0);
}

TEST_CASE("at twice the bound it swings ever higher, and the controller keeps it from that") {
  const Played wild = swing(2, 0);
  CHECK(wild.last > 10 * wild.first);
  const Played kept = swing(2, 5);
  CHECK(kept.last <= kept.first);
  CHECK(kept.interventions > 10);
  MESSAGE("energy after 3 s as a share of the first: " << wild.last / wild.first << " without, "
                                                       << kept.last / kept.first << " with the controller");
}

TEST_CASE("the observer counts what goes in and comes out, and keeps no more than springs can hold") {
  Passivity passivity(0, 5);
  passivity.observe({-2, 0, 0}, {0.01, 0, 0}, period);  // pushed in against 2 N
  CHECK(passivity.energy() == near(0.02, 1e-12));
  passivity.forget_above(0.015);
  passivity.observe({-2, 0, 0}, {-0.01, 0, 0}, period);
  CHECK(passivity.energy() == near(-0.005, 1e-12));
  CHECK(passivity.damping({0, 0, 0}, period) == 0);
  CHECK(passivity.damping({2, 0, 0}, period) == near(0.005 / (period * 4), 1e-12));
  CHECK(passivity.damping({0.1, 0, 0}, period) == 5);  // the most there is
}

TEST_CASE(
    "a little energy is left alone, debts are forgotten, and a restart knows what springs have stored") {
  Passivity passivity(0, 5, 1e-5);
  passivity.observe({1, 0, 0}, {0.9e-5, 0, 0}, period);  // 9 µJ come out
  CHECK(passivity.damping({0.1, 0, 0}, period) == 0);
  passivity.observe({1, 0, 0}, {0.2e-5, 0, 0}, period);
  CHECK(passivity.damping({0.1, 0, 0}, period) == near(1.1e-5 / (period * 0.01), 1e-12));
  for (int i = 0; i < 500; ++i) passivity.forget_debts(period);
  CHECK(passivity.energy() == near(-1.1e-5 * std::exp(-1.0), 1e-9));
  passivity.restart(2e-3);
  passivity.forget_debts(period);
  CHECK(passivity.energy() == 2e-3);
}
