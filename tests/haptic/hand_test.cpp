// A session, a haptic hand in it and a loop, in virtual time on one thread.
#include "lobe/haptic/haptic_hand.h"

#include <limits>

#include "haptic/virtual_loop.h"
#include "lobe/haptic/trial.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Vec3d in(0, 0, -1);

// To the place, down, held there, and back.
SimulatedHand::Path press(double depth, double speed, double hold = 0.3) {
  const bench::HandPath path{{{Vec3d::Zero(), 0, 0.2},
                              {depth * in, speed},
                              {Vec3d::Zero(), 0, hold},
                              {Vec3d::Zero(), speed},
                              {Vec3d::Zero(), 0, 0.3}}};
  return [path](double time) -> Vec3d { return path.at(time); };
}

}  // namespace

TEST_CASE("a hand that presses a block feels it, and no tool is anywhere else than the loop wants it") {
  VirtualLoop loop(block(), press(0.006, 0.1), 1.0 / 120);
  loop.take_hold();
  double highest = 0;
  loop.run(0.9, [&](const HapticState& state) {
    CHECK(state.force.allFinite());
    highest = std::max(highest, state.force.z());
  });
  CHECK(highest > 0.3);  // it pushes back
  CHECK(loop.servo().state().limited == 0);
  CHECK(loop.servo().state().interventions == 0);
  const auto hands = loop.session.status()->hands;
  REQUIRE(hands.size() == 1);
  CHECK((hands[0].pose.position - loop.servo().state().tool).norm() < 2e-4);
  CHECK(replays(loop.session, loop.setup));
}

TEST_CASE(
    "a hand that leads a blade feels the work of the cut against its way, and without work hardly "
    "anything") {
  for (const double fracture_energy : {0.0, 20.0}) {
    Setup setup = block();
    setup.materials[0].fracture_energy = fracture_energy;
    VirtualLoop loop(setup, press(0.03, 0.1), 1.0 / 120);
    const Vec3d tip = top + Vec3d(0, -0.05, 0.004), heel = top + Vec3d(0, 0.05, 0.004);
    loop.controller.send(bring_tool(1, tip, BringScalpel{"", {tip, heel}}));
    loop.controller.send(turn_on(Kind::turn_on, true, 1));
    double highest = 0, across = 0;
    loop.run(0.5, [&](const HapticState& state) {
      CHECK(state.force.allFinite());
      highest = std::max(highest, state.force.z());
      across = std::max(across, std::hypot(state.force.x(), state.force.y()));
    });
    CHECK(loop.session.world().elements().topology.tet_copy_count() > 10);
    if (fracture_energy == 0) {
      CHECK(highest < 0.02);  // the coupling damps the device by 0.125 N s/m
    } else {
      CHECK(highest > 0.5 * 20 * 0.05);  // of what a straight cut as wide as the block takes
      CHECK(highest < 3 * 20 * 0.05);
      CHECK(across < 0.2 * highest);
    }
    CHECK(replays(loop.session, loop.setup));
  }
}

TEST_CASE("a device that is held aslant twists nothing, and one that turns turns what it holds by as much") {
  const Vec3d axis = Vec3d(1, -2, 0.5).normalized();
  const Eigen::Quaterniond aslant(Eigen::AngleAxisd(2.0, axis));
  const auto rests = [](double) -> Vec3d { return Vec3d::Zero(); };
  VirtualLoop straight(block(), rests, 1.0 / 120), turned(block(), rests, 1.0 / 120);
  DeviceState held{.orientation = aslant.coeffs()};
  turned.change = [&](DeviceState& state) { state.orientation = held.orientation; };
  const auto nothing = [](const HapticState&) {};
  for (VirtualLoop* loop : {&straight, &turned}) {
    loop->take_hold();
    loop->run(0.3, nothing);
  }
  const auto hand_of = [](VirtualLoop& loop) { return loop.session.status()->hands.at(0); };
  const auto turn_of = [&](VirtualLoop& loop) { return Eigen::Quaterniond(hand_of(loop).pose.orientation); };
  CHECK(turn_of(turned).angularDistance(Eigen::Quaterniond::Identity()) < 1e-7);
  CHECK((hand_of(turned).torque - hand_of(straight).torque).norm() < 1e-6);

  constexpr double angle = 0.3;
  const Eigen::Quaterniond by(Eigen::AngleAxisd(angle, Vec3d::UnitY()));
  held.orientation = (by * aslant).coeffs();
  turned.run(0.3, nothing);
  CHECK(turn_of(turned).angularDistance(by) < 1e-7);
  CHECK(hand_of(turned).torque.y() < -1e-3);  // the block resists
  CHECK(replays(turned.session, turned.setup));
}

// Blending would take 4 ms. A device that bears 0.2 N per tick needs one more.
TEST_CASE("letting go ends the force within 15 ms, evenly") {
  VirtualLoop loop(block(), press(0.006, 0.1), 1.0 / 120);
  loop.take_hold();
  loop.run(0.45, [](const HapticState&) {});
  double before = loop.servo().state().force.norm();
  const double whole = before;
  CHECK(whole > 0.3);
  loop.controller.send(ask(Kind::let_go));
  int ticks = 0, falling = 0;
  loop.run(0.1, [&](const HapticState& state) {
    const double now = state.force.norm();
    if (++ticks > 9) CHECK(now <= before + 1e-12);
    falling += before - now > 0.1 * whole;
    if (ticks >= 15) CHECK(now == 0);
    before = now;
  });
  CHECK(falling >= 4);
  CHECK(loop.servo().state().limited <= 5);
}

// The force fades by a fiftieth per tick, of what it would be. That grows in proportion to the depth, as the
// fading force lets the hand go in, to at most the 6 mm where it wants to be.
TEST_CASE("a simulation that stands still for 200 ms: the force fades, and comes back") {
  VirtualLoop loop(block(), press(0.006, 0.1, 1), 1.0 / 120);
  loop.take_hold();
  loop.run(0.45, [](const HapticState&) {});
  const double whole = loop.servo().state().force.norm();
  CHECK(whole > 0.3);
  const double depth = in.dot(loop.hand_position());
  loop.stall(0.2);
  double lowest = whole, highest = 0, jump = 0;
  Vec3d before = loop.servo().state().force;
  loop.run(0.2, [&](const HapticState& state) {
    lowest = std::min(lowest, state.force.norm());
    highest = std::max(highest, state.force.norm());
    jump = std::max(jump, (state.force - before).norm());
    before = state.force;
  });
  CHECK(jump <= 0.02 * whole * (0.006 / depth));
  CHECK(loop.servo().state().limited == 0);
  CHECK(lowest == 0);
  CHECK(highest <= 1.1 * whole);
  loop.run(0.1, [](const HapticState&) {});
  CHECK(loop.servo().state().force.norm() > 0.3);
  CHECK(loop.servo().state().stale > 100);
  CHECK(loop.servo().state().stalls == 1);
  CHECK(times_said(loop.session, "haptic_stale") == 1);
}

namespace {

// While its force fades, the hand goes as deep as it wants to be. When it is back, that place stands for the
// one where it was. So it presses as a hand does that wants to be there.
double force_after_return(double depth) {
  VirtualLoop loop(block(), press(depth, 0.1, 1), 1.0 / 120);
  loop.take_hold();
  loop.run(0.75, [](const HapticState&) {});
  return loop.servo().state().force.norm();
}

}  // namespace

TEST_CASE("a device that sends what is no pose while it presses: told of once, and the force fades") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool in_orientation : {false, true}) {
    CAPTURE(in_orientation);
    VirtualLoop loop(block(), press(0.006, 0.1, 1), 1.0 / 120);
    loop.take_hold();
    loop.run(0.45, [](const HapticState&) {});
    const double whole = loop.servo().state().force.norm();
    CHECK(whole > 0.3);
    const double returning = force_after_return(in.dot(loop.hand_position()));
    loop.change = [&](DeviceState& state) {
      if (in_orientation)
        state.orientation[2] = nan;
      else
        state.position.y() = nan;
    };
    loop.run(0.3, [&](const HapticState& state) {
      CHECK(state.force.allFinite());
      CHECK(state.force.norm() <= 1.1 * whole);
      CHECK(state.tool.allFinite());
      CHECK(state.orientation.allFinite());
    });
    CHECK(loop.servo().state().force.norm() == 0);
    CHECK(loop.servo().state().bad_poses == 300);
    CHECK(times_said(loop.session, "haptic_pose") == 1);
    CHECK(times_said(loop.session, "haptic_gone") == 0);
    loop.change = nullptr;
    loop.run(0.2, [](const HapticState&) {});
    CHECK(loop.servo().state().force.norm() == near(returning, 0.05));
    CHECK(times_said(loop.session, "haptic_pose") == 1);
    CHECK(replays(loop.session, loop.setup));
  }
}

TEST_CASE("a device that is unplugged while it presses: told of, and the force fades") {
  VirtualLoop loop(block(), press(0.006, 0.1, 1), 1.0 / 120);
  loop.take_hold();
  loop.run(0.45, [](const HapticState&) {});
  const double returning = force_after_return(in.dot(loop.hand_position()));
  loop.hand.unplug(true);
  loop.run(0.3, [](const HapticState& state) { CHECK(state.force.norm() < 3); });
  CHECK(loop.servo().state().force.norm() == 0);
  CHECK(times_said(loop.session, "haptic_gone") == 1);
  loop.hand.unplug(false);
  loop.run(0.2, [](const HapticState&) {});
  CHECK(loop.servo().state().force.norm() == near(returning, 0.05));
}

TEST_CASE(
    "a device that comes back elsewhere leaves the tool where it holds tissue, and leads it from there") {
  const Vec3d elsewhere(0.1, -0.2, 0.3), further(0.002, 0, 0);
  VirtualLoop loop(block(), press(0.006, 0.1, 2), 1.0 / 120);
  const auto place = [&] { return loop.session.status()->hands.at(0).pose.position; };
  loop.take_hold();
  loop.run(0.6, [](const HapticState&) {});
  const double whole = loop.servo().state().force.norm();
  const Vec3d held = place();
  CHECK(whole > 0.3);
  loop.hand.unplug(true);
  loop.run(0.2, [](const HapticState&) {});
  loop.hand.unplug(false);
  DeviceState device{.position = elsewhere};
  loop.change = [&](DeviceState& state) { state = device; };
  loop.run(0.3, [&](const HapticState& state) {
    CHECK((place() - held).norm() < 1e-3);
    CHECK(state.force.norm() < 1.1 * whole);
  });
  CHECK(loop.servo().state().force.norm() == near(whole, 0.1));
  CHECK(loop.servo().state().limited == 0);
  const Vec3d back = place();
  device.position += further;
  loop.run(0.5, [](const HapticState&) {});
  CHECK((place() - back).x() > 0.5 * further.norm());
  CHECK((place() - back).norm() < further.norm());
  CHECK(replays(loop.session, loop.setup));
}

TEST_CASE("a device that is plugged in only after it has taken hold leaves the tool where it is") {
  const Vec3d elsewhere(0.1, -0.2, 0.3);
  VirtualLoop loop(
      block(), [&](double) { return elsewhere; }, 1.0 / 120);
  const auto place = [&] { return loop.session.status()->hands.at(0).pose.position; };
  loop.hand.unplug(true);
  loop.take_hold();
  loop.run(0.2, [](const HapticState& state) { CHECK(state.force.norm() == 0); });
  const Vec3d taken = place();
  loop.hand.unplug(false);
  loop.run(0.3, [&](const HapticState& state) {
    CHECK(state.force.norm() < 0.01);
    CHECK((place() - taken).norm() < 1e-4);
  });
  CHECK(times_said(loop.session, "haptic_gone") == 0);
}

// What is loose springs back, without damping as far as it was pressed: no force is higher than before.
TEST_CASE(
    "tissue that is cut away under the hand: the force jumps by no more than the device bears, and falls") {
  VirtualLoop loop(block(), press(0.006, 0.1), 1.0 / 120);
  loop.take_hold();
  loop.run(0.45, [](const HapticState&) {});
  RemoveTets cut;
  for (Index t = 0; t < loop.setup.mesh.tet_count(); ++t)
    if (std::abs(barycentre(loop.setup.mesh, t).z() - 0.035) < 0.006) cut.tets.push_back(t);
  loop.controller.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(cut)});
  Vec3d before = loop.servo().state().force;
  const double whole = before.norm();
  double highest = 0;
  loop.run(0.2, [&](const HapticState& state) {
    highest = std::max(highest, state.force.norm());
    CHECK((state.force - before).norm() <= 0.2 + 1e-12);
    before = state.force;
  });
  CHECK(loop.servo().state().limited > 0);  // it would have jumped by more
  CHECK(highest < 1.1 * whole);
  CHECK(before.norm() < 0.3 * whole);
}

TEST_CASE("over presses and releases no energy comes out, whatever the frames") {
  for (double frame : {1e-3, 1.0 / 120, 0.05}) {
    CAPTURE(frame);
    VirtualLoop loop(block(), press(0.006, 0.1), frame);
    loop.take_hold();
    const auto [given, stored] = loop.energy_over(1.0);
    MESSAGE("energy given to the hand " << 100 * given / stored << " % of the " << 1e3 * stored
                                        << " mJ stored; interventions "
                                        << loop.servo().state().interventions);
    CHECK(stored > 1e-4);
    CHECK(given <= 0.01 * stored);
  }
}

// In virtual time, in which a frame takes no time to compute: that must be added. The hand begins to move at
// any tick of three frames, which are 25 ticks: two of them are 8 ticks long, and one 9. The tick after a
// frame has the model of that frame.
TEST_CASE("a force answers a hand that starts to move: the local model at once, the body by the next frame") {
  constexpr double speed = 0.1, tick = 1e-3, change = 1e-3;  // [m/s], [s], [N]
  for (const double frame : {tick, 1.0 / 120}) {
    int latest = 0;
    for (int phase = 0; phase < (frame > tick ? 25 : 1); ++phase) {
      CAPTURE(frame);
      CAPTURE(phase);
      VirtualLoop loop(block(), press(0, 1), frame);
      DeviceState device;
      loop.change = [&](DeviceState& state) { state = device; };
      loop.take_hold();
      loop.run(1 + phase * tick, [](const HapticState&) {});
      const Vec3d force = loop.servo().state().force;
      const auto of_body = [&] { return loop.session.status()->hands.at(0).force; };
      const Vec3d resting = of_body();
      loop.run(0.01, [&](const HapticState&) { REQUIRE((of_body() - resting).norm() < 0.1 * change); });
      int felt = -1, answered = -1, ticks = 0;  // since the hand began to move
      device.velocity = speed * in;
      device.position = speed * tick * in;
      loop.run(0.03, [&](const HapticState& state) {
        if (felt < 0 && (state.force - force).norm() > change) felt = ticks;
        if (answered < 0 && (of_body() - resting).norm() > change) answered = ticks;
        ++ticks;
        device.position += speed * tick * in;
      });
      CHECK(felt == 0);
      REQUIRE(answered >= 0);
      latest = std::max(latest, answered);
    }
    CHECK(latest == (frame > tick ? 9 : 1));  // at most 2, and a frame and 2 [ms], are aimed at
  }
}

TEST_CASE("the trial says what frames of 1 ms cost, and chooses by it") {
  const HapticTrial trial = try_direct<float>(block(), 1, 50);
  CHECK(trial.frames == 50);
  CHECK(trial.p50 > 0);
  CHECK(trial.p50 <= trial.p99);
  CHECK(trial.is_direct == (trial.p99 < 0.7e-3));
}
