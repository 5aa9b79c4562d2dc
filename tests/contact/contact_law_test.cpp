// The law of depths at which contact is held (contact_law.h), for one point between a load and a stop.
#include <doctest/doctest.h>

#include <cmath>

#include "lobe/contact/contact_law.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A unit mass on a spring k, pressed by a load against a stop of stiffness κ (for an area of 1), in central
// differences as a world makes them.
struct Pressed {
  ContactLaw law;
  double k = 0, stiffness = 0, load = 0, damping = 0;  // [N/m], [N/m], [N], γ [1/s]
  double x = 0, v = 0, held = 0;                       // x: the depth [m]

  void step(double dt) {
    const double force = load - k * x - law.pressure(x, held, stiffness);
    held = law.held_after(dt, x, held);
    v = ((1 - damping * dt / 2) * v + dt * force) / (1 + damping * dt / 2);
    x += dt * v;
  }
  void play(double seconds, double dt = 1e-4) {
    for (long n = std::lround(seconds / dt); n > 0; --n) step(dt);
  }
  double amplitude() const { return std::hypot(x, v / std::sqrt(k + stiffness)); }  // about rest at no depth
};

constexpr double deep = 1e3;  // no bound is met [m]

}  // namespace

TEST_CASE(
    "what is held is the depth summed over time, at least 0, and grows no more where pressure does not") {
  const ContactLaw law{.hold = 8, .deepest = 0.003};
  double held = 0;
  for (int i = 0; i < 100; ++i) held = law.held_after(1e-3, 2e-4, held);
  CHECK(held == near(8 * 0.1 * 2e-4, 1e-12));
  CHECK(law.held_after(1e-3, -1, held) == 0);
  CHECK(law.held_after(1e-3, 0.003, held) == held);
  CHECK(law.pressure(0.003, held, 1e7) == near(1e7 * 0.003, 1e-12));
  CHECK(law.pressure(-2 * held, held, 1e7) == 0);
  CHECK(law.pressure(-held / 2, held, 1e7) == near(1e7 * held / 2, 1e-12));
}

TEST_CASE("pressure is the slope of the energy, held or not, below the deepest depth and beyond") {
  const ContactLaw law{.hold = 8, .deepest = 0.003};
  constexpr double stiffness = 1e7, h = 1e-7;
  for (double held : {0.0, 4e-4})
    for (double depth : {-1e-3, -2e-4, 1e-4, 2e-3, 5e-3}) {
      CAPTURE(held);
      CAPTURE(depth);
      const double slope =
          (law.energy(depth + h, held, stiffness) - law.energy(depth - h, held, stiffness)) / (2 * h);
      CHECK(law.pressure(depth, held, stiffness) == near(slope, 1e-6, stiffness * 1e-6));
    }
}

TEST_CASE("at rest a held contact bears its load at no depth, another at load over stiffness") {
  Pressed held{.law = {.hold = 10, .deepest = deep}, .stiffness = 400, .load = 2, .damping = 20};
  held.play(8, 1e-3);
  CHECK(std::abs(held.x) < 1e-12);
  CHECK(held.held == near(2.0 / 400, 1e-9));
  Pressed loose{.law = {.hold = 0, .deepest = deep}, .stiffness = 400, .load = 2, .damping = 20};
  loose.play(8, 1e-3);
  CHECK(loose.x == near(2.0 / 400, 1e-9));
  CHECK(loose.held == 0);
}

// With k = 0 and weak damping the roots of s³ + γ s² + ω² s + ρ ω² = 0 near ± iω have the real part (ρ −
// γ)/2.
TEST_CASE("a motion about rest dies away if less is held than damping allows, and grows if more is") {
  constexpr double omega = 60, damping = 4;
  for (double share : {0.5, 1.0, 1.5}) {
    CAPTURE(share);
    Pressed point{.law = {.hold = share * damping, .deepest = deep},
                  .stiffness = omega * omega,
                  .load = 1e3,
                  .damping = damping};
    point.held = point.load / point.stiffness;  // at rest, but for its speed
    point.v = 1e-3;
    point.play(0.2);
    const double early = point.amplitude();
    point.play(2);
    CHECK(std::log(point.amplitude() / early) == near((share - 1) * damping / 2 * 2, 0.05, 1.0));
  }
}

TEST_CASE("a spring in parallel leaves room: twice the damping may be held where it is as stiff as contact") {
  for (double share : {1.9, 2.3}) {
    CAPTURE(share);
    Pressed point{
        .law = {.hold = share * 4, .deepest = deep}, .k = 3600, .stiffness = 3600, .load = 1e3, .damping = 4};
    point.held = point.load / point.stiffness;
    point.v = 1e-3;
    point.play(0.5);
    const double early = point.amplitude();
    point.play(4);
    CHECK((point.amplitude() < early) == (share < 2));
  }
}

// Why tools hold nothing where masses are lumped.
TEST_CASE("who presses, waits and goes back gets the energy of what was held, and none where nothing is") {
  constexpr double stiffness = 1e7, depth = 2e-4, wait = 0.1;
  for (double hold : {0.0, 10.0}) {
    const ContactLaw law{.hold = hold, .deepest = deep};
    const double given = law.energy(depth, 0, stiffness);
    const double held = law.held_after(wait, depth, 0);
    const double taken = law.energy(depth, held, stiffness) - law.energy(-held, held, stiffness);
    const double more = stiffness / 2 * ((depth + held) * (depth + held) - depth * depth);
    CHECK(taken - given == near(more, 1e-12, given));
    CHECK((taken > given) == (hold > 0));
  }
}
