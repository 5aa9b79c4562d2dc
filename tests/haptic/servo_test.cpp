#include "lobe/haptic/servo.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "lobe/error.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double tick = 1e-3;

// A spring of 400 N/m that holds a tool at the origin.
LocalModel spring(double time = 1, const Vec3d& force = Vec3d::Zero()) {
  LocalModel model{.is_engaged = true, .engagement = 1, .time = time};
  model.force = force;
  model.K = Vec3d(400, 400, 200).asDiagonal();
  return model;
}

DeviceState at(const Vec3d& position, const Vec3d& velocity = Vec3d::Zero()) {
  return {.position = position, .velocity = velocity};
}

// Until the force has risen to what the spring gives, but before the model is stale.
Vec3d settled(Servo& servo, const DeviceState& device, const LocalModel& model) {
  LocalModel again = model;
  for (int i = 0; i < 2000; ++i) {
    again.time += 1e-6;
    servo.tick(&device, again, tick);
  }
  return servo.state().force;
}

}  // namespace

TEST_CASE("the coupling and the body are springs in series, between which the tool is") {
  Servo servo({.stiffness = 1000, .damping = 10}, {});
  const DeviceState origin = at(Vec3d::Zero());
  servo.tick(&origin, spring(), tick);  // takes the tool up
  const Vec3d force = settled(servo, at({0.005, 0, 0.002}), spring());
  CHECK(force.x() == near(-0.005 * 1000 * 400 / 1400.0, 1e-9));
  CHECK(force.z() == near(-0.002 * 1000 * 200 / 1200.0, 1e-9));
  CHECK(servo.state().tool.x() == near(0.005 * 1000 / 1400.0, 1e-9));
}

TEST_CASE("a tool that only touches is pushed along the normal, and never drawn") {
  LocalModel model = spring(1, {0, 0, 1});
  model.is_bilateral = false;
  model.position = {0, 0, 0};
  CHECK(force_at(model, {0.001, 0, 0}).isApprox(Vec3d(0, 0, 1)));
  CHECK(force_at(model, {0, 0, -0.001}).z() == near(1.2, 1e-12));
  CHECK(force_at(model, {0, 0, 0.006}).norm() == 0);
  for (double z : {-0.01, -0.001, 0.0, 0.004, 0.01}) {
    const Proxy proxy = quasi_static_proxy(model, {0.001, 0, z}, 500, Vec3d::Zero());
    CHECK((500 * (Vec3d(0.001, 0, z) - proxy.position) + proxy.force).norm() < 1e-12);
    CHECK((proxy.force - force_at(model, proxy.position)).norm() < 1e-12);
  }
}

TEST_CASE("friction goes with the push in proportion") {
  LocalModel model = spring(1, {0.2, 0, 1});
  model.is_bilateral = false;
  CHECK(force_at(model, {0, 0, -0.005}).isApprox(2 * Vec3d(0.2, 0, 1)));
}

TEST_CASE("a new model is blended in: the force has no jump, and ends where the model says") {
  Servo servo({.slew = 1e9, .stiffness = 1000, .damping = 10}, {.highest_damping = 0});
  const DeviceState still = at(Vec3d::Zero());
  LocalModel model = spring();
  for (int i = 0; i < 60; ++i, model.time += 1e-6) servo.tick(&still, model, tick);
  const LocalModel next = spring(2, {0.7, 0, 0});
  double before = servo.state().force.x();
  CHECK(before == 0);
  double most = 0;
  for (int i = 0; i < 10; ++i) {
    const double now = servo.tick(&still, next, tick).force.x();
    most = std::max(most, std::abs(now - before));
    before = now;
  }
  CHECK(before == near(0.7 * 1000 / 1400, 1e-9));
  CHECK(most == near(before / 4, 0.01));  // evenly over 4 ms
}

TEST_CASE(
    "a small difference to a new model is gone sooner: the force changes at the least rate of blending") {
  const ServoOptions options{.blend_rate = 5, .highest_damping = 0};
  Servo servo({.slew = 1e9, .stiffness = 1e9, .damping = 1e6}, options);
  const DeviceState still = at(Vec3d::Zero());
  LocalModel model = spring(1, {0.7, 0, 0});
  for (int i = 0; i < 60; ++i, model.time += 1e-6) servo.tick(&still, model, tick);
  for (double change : {0.012, -0.004}) {
    const double before = servo.state().force.x();
    model.time += 1;
    model.force.x() += change;
    for (int i = 1; i <= 4; ++i) {
      const double way = std::min(std::abs(change), i * options.blend_rate * tick);
      CHECK(servo.tick(&still, model, tick).force.x() == near(before + std::copysign(way, change), 1e-5));
    }
  }
}

TEST_CASE("the force of a model changes at its rate, from the middle of its frame on, for two frames") {
  LocalModel model = spring(1, {0.2, 0, 0});
  model.frame = 0.01;
  model.rate = {30, 0, -10};
  CHECK(aged(model, 0).force.isApprox(Vec3d(0.2 + 0.005 * 30, 0, -0.005 * 10)));
  CHECK(aged(model, 0.004).force.isApprox(Vec3d(0.2 + 0.009 * 30, 0, -0.009 * 10)));
  CHECK(aged(model, 1).force.isApprox(Vec3d(0.2 + 0.020 * 30, 0, -0.020 * 10)));
  Servo servo({.slew = 1e9, .stiffness = 1e9, .damping = 1e6}, {.longest_blend = 0, .highest_damping = 0});
  const DeviceState still = at(Vec3d::Zero());
  LocalModel fresh = spring();
  for (int i = 0; i < 60; ++i, fresh.time += 1e-6) servo.tick(&still, fresh, tick);
  for (int i = 1; i <= 8; ++i)
    CHECK(servo.tick(&still, model, tick).force.x() == near(0.2 + (0.005 + i * tick) * 30, 1e-5));
}

TEST_CASE("with a new model in each tick, as in the direct mode, the force is that of the models") {
  Servo servo({.slew = 1e9, .stiffness = 1000, .damping = 10}, {.highest_damping = 0});
  const DeviceState still = at(Vec3d::Zero());
  LocalModel model = spring();
  model.frame = tick;
  for (int i = 0; i < 60; ++i, model.time += tick) servo.tick(&still, model, tick);
  for (int i = 0; i < 10; ++i, model.time += tick) {
    model.force.x() = 0.1 * i;
    CHECK(servo.tick(&still, model, tick).force.x() == near(0.1 * i * 1000 / 1400, 1e-9, 1.0));
  }
}

TEST_CASE("a model that is too old fades to nothing, and a new one comes back as slowly") {
  const ServoOptions options;
  Servo servo({.stiffness = 1000, .damping = 10}, options);
  const DeviceState origin = at(Vec3d::Zero()), pressed = at({0.005, 0, 0});
  servo.tick(&origin, spring(), tick);
  const double whole = settled(servo, pressed, spring()).norm();
  CHECK(whole > 1);
  LocalModel last = spring(3);
  double before = whole;
  int ticks = 0, until_nothing = 0;
  for (; ticks < 200; ++ticks) {
    const double now = servo.tick(&pressed, last, tick).force.norm();
    CHECK(now <= before + 1e-12);
    CHECK(before - now <= 200 * tick + 1e-12);
    if (now > 0) until_nothing = ticks;
    before = now;
  }
  CHECK(before == 0);
  CHECK(servo.state().stale > 100);
  CHECK(until_nothing * tick == near(options.stale_frames / 120 + options.fade, 0.05));
  CHECK(settled(servo, pressed, spring(4)).norm() == near(whole, 1e-9));
}

TEST_CASE("a pose that is not finite, and a device that is gone: counted, bounded, faded") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (bool unplugged : {false, true}) {
    CAPTURE(unplugged);
    Servo servo({.stiffness = 1000, .damping = 10}, {});
    const DeviceState origin = at(Vec3d::Zero()), pressed = at({0.005, 0, 0}), bad = at({nan, 0, 0});
    servo.tick(&origin, spring(), tick);
    const double whole = settled(servo, pressed, spring()).norm();
    LocalModel model = spring(3);
    for (int i = 0; i < 80; ++i, model.time += 1e-6) {
      const HapticState& state = servo.tick(unplugged ? nullptr : &bad, model, tick);
      CHECK(state.force.allFinite());
      CHECK(state.tool.allFinite());
      CHECK(state.force.norm() <= whole + 1e-12);
    }
    CHECK(servo.state().force.norm() == 0);
    CHECK(servo.state().bad_poses == (unplugged ? 0 : 80));
    CHECK(servo.state().absent == (unplugged ? 80 : 0));
    CHECK(settled(servo, pressed, spring(4)).norm() == near(whole, 1e-9));  // it comes back
  }
}

TEST_CASE("no force is above what the device bears, nor changes faster") {
  Servo servo({.force = 2, .slew = 100, .stiffness = 1000, .damping = 10}, {});
  const DeviceState origin = at(Vec3d::Zero());
  servo.tick(&origin, spring(), tick);
  Vec3d before = Vec3d::Zero();
  for (int i = 0; i < 400; ++i) {  // a hand that jumps by decimetres, and turns back
    const DeviceState device = at({0.3 * ((i / 50) % 3), -0.2 * ((i / 70) % 2), 0});
    const Vec3d force = servo.tick(&device, spring(1 + 0.001 * i), tick).force;
    CHECK(force.norm() <= 2 * (1 + 1e-12));
    CHECK((force - before).norm() <= 0.1 * (1 + 1e-9));
    before = force;
  }
  // In 50 ticks it stays at the origin, and three times 20 ticks take the force from 2 N to 0, where 30
  // follow: 290.
  CHECK(servo.state().limited > 280);
  CHECK(servo.state().limited <= 290);
}

TEST_CASE(
    "a torque is turned into the workspace, fades with its model, and is no higher than the device bears") {
  Workspace space;
  space.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // the device's x is the tool's y
  Servo servo({.torque = 0.1, .damping = 10}, {.workspace = space});
  const DeviceState still = at(Vec3d::Zero());
  LocalModel model = spring();
  model.torque = {0.03, 0.04, 0.01};
  settled(servo, still, model);
  CHECK((servo.state().torque - Vec3d(0.04, -0.03, 0.01)).norm() < 1e-15);
  model.torque = {0.6, 0.8, 0};
  model.time = 2;
  settled(servo, still, model);
  CHECK((servo.state().torque - Vec3d(0.08, -0.06, 0)).norm() < 1e-15);
  for (int i = 0; i < 100; ++i) servo.tick(&still, LocalModel(model), tick);  // no new one comes
  CHECK(servo.state().torque.norm() == 0);
}

TEST_CASE("a tool is taken up where it is, without a force") {
  Servo servo({.damping = 10}, {});
  const DeviceState device = at({0.1, 0.2, 0.3});
  LocalModel model = spring();
  model.tool_at_end = {0.01, 0, 0};
  model.position = {0.01, 0, 0};
  for (int i = 0; i < 20; ++i) CHECK(servo.tick(&device, model, tick).force.norm() < 1e-12);
  CHECK(servo.state().tool.isApprox(model.tool_at_end));
  CHECK(servo.state().engagement == 1);
}

TEST_CASE("a tool is taken up with the orientation that it has, and turns as the device does from there") {
  using Quaternion = Eigen::Quaterniond;
  Workspace space;
  space.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // the device's x is the tool's y
  const Quaternion held(Eigen::AngleAxisd(2.0, Vec3d(1, -2, 0.5).normalized()));
  const Quaternion of_tool(Eigen::AngleAxisd(0.7, Vec3d(0.3, 1, 1).normalized()));
  for (bool turns_space : {false, true}) {
    CAPTURE(turns_space);
    Servo servo({.damping = 10}, {.workspace = turns_space ? space : Workspace{}});
    LocalModel model = spring();
    model.turn_at_end = of_tool.coeffs();
    DeviceState device = at(Vec3d::Zero());
    device.orientation = held.coeffs();
    for (int i = 0; i < 20; ++i) {
      const Quaternion turn(servo.tick(&device, model, tick).orientation);
      CHECK(turn.angularDistance(of_tool) < 1e-7);
    }
    const Quaternion by(Eigen::AngleAxisd(0.4, Vec3d::UnitX()));
    device.orientation = (by * held).coeffs();
    const Quaternion turned(servo.tick(&device, model, tick).orientation);
    const Quaternion seen(Eigen::AngleAxisd(0.4, turns_space ? Vec3d::UnitY() : Vec3d::UnitX()));
    CHECK(turned.angularDistance(seen * of_tool) < 1e-7);
    // The next tool is taken up anew.
    model.engagement = 2;
    model.turn_at_end = Quaternion::Identity().coeffs();
    const Quaternion next(servo.tick(&device, model, tick).orientation);
    CHECK(next.angularDistance(Quaternion::Identity()) < 1e-7);
  }
}

TEST_CASE("a device that has no pose when a tool is taken up moves and turns it from its first pose on") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3d place(0.2, 0.1, 0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vec3d::UnitX()));
  const Eigen::Quaterniond aslant(Eigen::AngleAxisd(2.0, Vec3d(1, -2, 0.5).normalized()));
  for (const bool was_heard : {false, true})
    for (const bool unplugged : {false, true}) {
      CAPTURE(was_heard);
      CAPTURE(unplugged);
      Servo servo({.stiffness = 1000, .damping = 10}, {});
      const DeviceState early = at({0, 0.05, 0}), bad = at({nan, 0, 0});
      if (was_heard) servo.tick(&early, {}, tick);
      LocalModel model = spring();
      model.position = model.tool_at_end = place;
      model.turn_at_end = turn.coeffs();
      const auto is_taken_up = [&](const HapticState& state) {
        return (state.tool - place).norm() < 1e-12 &&
               Eigen::Quaterniond(state.orientation).angularDistance(turn) < 1e-7;
      };
      for (int i = 0; i < 50; ++i, model.time += 1e-6)
        CHECK(is_taken_up(servo.tick(unplugged ? nullptr : &bad, model, tick)));
      DeviceState device = at({-0.3, 0.4, 0.1});
      device.orientation = aslant.coeffs();
      for (int i = 0; i < 100; ++i, model.time += 1e-6) {
        CHECK(is_taken_up(servo.tick(&device, model, tick)));
        CHECK(servo.state().force.norm() < 1e-12);
      }
      const Eigen::Quaterniond by(Eigen::AngleAxisd(0.3, Vec3d::UnitY()));
      device.orientation = (by * aslant).coeffs();
      device.position.x() += 0.005;
      CHECK(settled(servo, device, model).x() == near(-0.005 * 1000 * 400 / 1400.0, 1e-9));
      CHECK(Eigen::Quaterniond(servo.state().orientation).angularDistance(by * turn) < 1e-7);
    }
}

TEST_CASE("a device that was gone and comes back elsewhere moves and turns the tool from its first pose on") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Quaterniond aslant(Eigen::AngleAxisd(2.0, Vec3d(1, -2, 0.5).normalized()));
  const Eigen::Quaterniond by(Eigen::AngleAxisd(0.3, Vec3d::UnitY()));
  Workspace space;
  space.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // the device's x is the tool's y
  for (const int away : {1, 20, 100})
    for (const bool unplugged : {false, true}) {
      CAPTURE(away);
      CAPTURE(unplugged);
      Servo servo({.stiffness = 1000, .damping = 10}, {.workspace = space});
      const DeviceState origin = at(Vec3d::Zero()), pressed = at({0.005, 0, 0}), bad = at({nan, 0, 0});
      LocalModel model = spring();
      servo.tick(&origin, model, tick);
      const double force = 0.005 * 1000 * 400 / 1400.0;
      REQUIRE(settled(servo, pressed, model).x() == near(-force, 1e-9));
      const Vec3d tool = servo.state().tool;
      const auto stays = [&](const HapticState& state) {
        return (state.tool - tool).norm() < 1e-9 && state.force.norm() < force + 1e-9 &&
               Eigen::Quaterniond(state.orientation).angularDistance(Eigen::Quaterniond::Identity()) < 1e-7;
      };
      for (int i = 0; i < away; ++i, model.time += 1e-6)
        CHECK(stays(servo.tick(unplugged ? nullptr : &bad, model, tick)));
      DeviceState device = at({-0.3, 0.4, 0.1});
      device.orientation = aslant.coeffs();
      for (int i = 0; i < 100; ++i, model.time += 1e-6) CHECK(stays(servo.tick(&device, model, tick)));
      CHECK(servo.state().force.x() == near(-force, 1e-9));  // as if it had not been moved
      device.orientation = (by * aslant).coeffs();
      device.position.x() += 0.002;
      CHECK(settled(servo, device, model).x() == near(-force * 7 / 5, 1e-9));
      CHECK(servo.state().tool.y() == near(tool.y() * 7 / 5, 1e-9));
      const Eigen::Quaterniond seen(Eigen::AngleAxisd(0.3, -Vec3d::UnitX()));
      CHECK(Eigen::Quaterniond(servo.state().orientation).angularDistance(seen) < 1e-7);
    }
}

TEST_CASE("a device without a tool that was gone is where it is") {
  Servo servo({.damping = 10}, {});
  const DeviceState here = at({0.1, 0, 0}), there = at({0, 0.2, 0});
  servo.tick(&here, {}, tick);
  servo.tick(nullptr, {}, tick);
  CHECK(servo.tick(&there, {}, tick).tool == there.position);
}

TEST_CASE("a device that does not turn gives a tool the bits of its orientation") {
  Servo servo({.damping = 10}, {});
  const DeviceState device = at({0.1, 0.2, 0.3});
  LocalModel model = spring();
  model.turn_at_end = Eigen::Vector4d(0.1, -0.7, 0.3, 0.2).normalized();
  for (int i = 0; i < 3; ++i) CHECK(servo.tick(&device, model, tick).orientation == model.turn_at_end);
}

TEST_CASE("a workspace turns and scales the way, and turns the force back") {
  Workspace space{.origin = {0, 0, 1}, .scale = 2, .force_gain = 0.5};
  space.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Servo servo({.stiffness = 1000, .damping = 10}, {.workspace = space});
  const DeviceState origin = at(Vec3d::Zero());
  LocalModel model = spring();
  model.tool_at_end = model.position = {0, 0, 1};
  servo.tick(&origin, model, tick);
  const Vec3d force = settled(servo, at({0.002, 0, 0}), model);  // 4 mm along y
  CHECK(force.x() == near(-0.5 * 0.004 * 1000 * 400 / 1400.0, 1e-9));
  CHECK(std::abs(force.y()) + std::abs(force.z()) < 1e-12);
}

TEST_CASE("the tool follows the device at once, and the yielding of the coupling slowly") {
  Servo servo({.stiffness = 1000, .damping = 10}, {.settling_frames = 6});
  const DeviceState origin = at(Vec3d::Zero()), pressed = at({0.005, 0, 0});
  LocalModel model = spring();
  servo.tick(&origin, model, tick);
  const double share = tick / (6 * model.frame + tick), balance = 0.005 * 1000 / 1400.0;
  double way = 0;
  for (int i = 0; i < 60; ++i) {
    model.time += 1e-6;
    servo.tick(&pressed, model, tick);
    way += share * (balance - 0.005 - way);
    CHECK(servo.state().tool.x() == near(0.005 + way, 1e-9));
  }
}

TEST_CASE("a device that moves is felt half a tick ahead, as far as Colgate's bound allows") {
  const Vec3d velocity(0.1, 0, 0);
  for (double damping : {10.0, 0.5}) {
    CAPTURE(damping);
    Servo servo({.stiffness = 1e9, .damping = damping}, {.highest_damping = 0});
    const DeviceState origin = at(Vec3d::Zero()), moving = at({0.005, 0, 0}, velocity);
    servo.tick(&origin, spring(), tick);
    const double K = servo.state().coupling, series = K * 400 / (K + 400), B = 0.25 * damping;
    const double bound = K * 600 / (K + 600);  // with the norm of the model's K, which is 600
    const double lead = std::min(tick / 2, (damping - B) / bound - tick / 2);
    CHECK(lead > 0);
    CHECK(settled(servo, moving, spring()).x() == near(-series * (0.005 + lead * 0.1) - B * 0.1, 1e-9));
  }
}

TEST_CASE("limits and options that are none are named") {
  CHECK_THROWS_WITH_AS(Servo({.force = 0}, {}), doctest::Contains("highest force"), InputError);
  CHECK_THROWS_WITH_AS(Servo({.damping = -1}, {}), doctest::Contains("damping"), InputError);
  CHECK_THROWS_WITH_AS(Servo({}, {.tick = 0}), doctest::Contains("tick"), InputError);
  CHECK_THROWS_WITH_AS(Servo({}, {.coupling_damping = 0.3}), doctest::Contains("quarter"), InputError);
  CHECK_THROWS_WITH_AS(Servo({}, {.fade = 0}), doctest::Contains("blending"), InputError);
  CHECK_THROWS_WITH_AS(Servo({}, {.workspace = {.scale = 0}}), doctest::Contains("scale"), InputError);
  const Workspace mirror{.rotation = Vec3d(1, 1, -1).asDiagonal()};
  CHECK_THROWS_WITH_AS(Servo({}, {.workspace = mirror}), doctest::Contains("no mirror"), InputError);
}
