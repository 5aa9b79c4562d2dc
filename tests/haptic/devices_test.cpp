#include "lobe/haptic/devices.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Device>
std::unique_ptr<Device> aimed_by_pointer() {
  if constexpr (std::is_same_v<Device, SimulatedHand>)
    return std::make_unique<Device>(SimulatedHand::Mechanics{}, nullptr);
  else
    return std::make_unique<Device>();
}

}  // namespace

TEST_CASE("a simulated hand is a mass on springs: it hangs by its weight, and swings as it must") {
  const SimulatedHand::Mechanics mechanics{.mass = 0.1, .damping = 0, .grip = 300, .grip_damping = 0};
  SimulatedHand hand(mechanics, [](double) -> Vec3d { return Vec3d::Zero(); });
  DeviceState state;
  hand.write({3, 0, 0}, Vec3d::Zero());
  double highest = 0;
  int ticks = 0;
  for (; ticks < 1000 && state.velocity.x() >= 0; ++ticks) {
    REQUIRE(hand.read(state));
    highest = std::max(highest, state.position.x());
  }
  CHECK(highest == near(2 * 3 / 300.0, 0.01));                                // twice the sag
  CHECK(ticks * 1e-3 == near(std::acos(-1.0) * std::sqrt(0.1 / 300), 0.03));  // half a period
}

TEST_CASE("a hand follows its path, and one that is unplugged does not answer") {
  SimulatedHand hand({}, [](double t) -> Vec3d { return {0.05 * t, 0, 0}; });
  DeviceState state;
  for (int i = 0; i < 1000; ++i) REQUIRE(hand.read(state));
  CHECK(state.velocity.x() == near(0.05, 0.01));
  CHECK(state.position.x() == near(0.05, 0.01));
  hand.unplug(true);
  CHECK_FALSE(hand.read(state));
  hand.unplug(false);
  CHECK(hand.read(state));
}

TEST_CASE("a mouse is no device until it has been aimed, then follows smoothly, and no faster than a hand") {
  MouseDevice mouse;
  DeviceState state;
  CHECK_FALSE(mouse.read(state));
  mouse.aim(Vec3d(0.1, 0, 0));
  REQUIRE(mouse.read(state));
  CHECK(state.position.isApprox(Vec3d(0.1, 0, 0)));
  mouse.aim(Vec3d(0.2, 0, 0));
  double before = state.position.x();
  for (int i = 0; i < 500; ++i) {
    REQUIRE(mouse.read(state));
    CHECK(state.position.x() - before <= 0.5e-3 + 1e-12);
    CHECK(state.velocity.x() == near((state.position.x() - before) / 1e-3, 1e-9, 0.5));
    before = state.position.x();
  }
  CHECK(before == near(0.2, 1e-4));
}

TEST_CASE_TEMPLATE("a pointer is where a tool is taken up, and goes from there to where it is aimed next",
                   Device, MouseDevice, SimulatedHand) {
  const Vec3d tool(0.3, 0, 0), old(-0.2, 0, 0), next(0.31, 0, 0);
  for (const bool aims_before : {false, true}) {
    const auto device = aimed_by_pointer<Device>();
    DeviceState state;
    const auto pass = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) REQUIRE(device->read(state));
    };
    device->aim(old);
    pass(10);
    device->aim(std::nullopt);
    if (aims_before) device->aim(next);
    device->begin_at(tool);
    pass(1);
    CHECK((state.position - tool).norm() < 1e-4);
    CHECK(state.velocity.norm() < 0.05);
    pass(600);
    CHECK(state.position.isApprox(aims_before ? next : tool, 1e-3));
    device->aim(next);
    pass(600);
    CHECK(state.position.isApprox(next, 1e-3));
  }
  const auto fresh = aimed_by_pointer<Device>();
  DeviceState state;
  CHECK_FALSE(fresh->read(state));
  fresh->begin_at(tool);
  REQUIRE(fresh->read(state));
  CHECK(state.position.isApprox(tool, 1e-4));
}

TEST_CASE("an external loop asks for its force whenever it likes") {
  HapticLink link;
  ExternalDevice device(link, {.stiffness = 1000, .damping = 10});
  LocalModel model{.is_engaged = true, .engagement = 1, .time = 1};
  model.K = 400 * Mat3<double>::Identity();
  const auto publish = [&] {
    model.time += 1e-3;
    *link.model.writable() = model;
    link.model.publish();
  };
  publish();
  DeviceState state;
  device.force(&state, 1e-3);
  state.position = {0, 0.005, 0};
  for (int i = 0; i < 100; ++i) {
    publish();
    device.force(&state, 1e-3);
  }
  CHECK(device.force(&state, 1e-3).force.y() == near(-0.005 * 1000 * 400 / 1400.0, 1e-9));
  CHECK(link.state.latest()->force.y() == near(-0.005 * 1000 * 400 / 1400.0, 1e-9));
  for (int i = 0; i < 100; ++i) device.force(nullptr, 1e-3);
  CHECK(device.force(nullptr).force.norm() == 0);  // by the clock
}
