// A session and a haptic loop in virtual time: frames are due as by a clock, each takes `compute` of its
// length, and the loop ticks in between, all on one thread.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>

#include "benchmarks/haptic_rig.h"
#include "live/hands_support.h"
#include "lobe/haptic/devices.h"
#include "lobe/haptic/haptic_hand.h"

namespace lobe::test {

class VirtualLoop {
 public:
  VirtualLoop(const Setup& of, SimulatedHand::Path path, double frame)
      : setup(of),
        session(setup, {.frame = frame}),
        controller(session.connect("hand")),
        hand({}, std::move(path)),
        hook_(std::make_unique<HapticHand<float>>(
            session, link,
            typename HapticHand<float>::Settings{.controller = controller.number(),
                                                 .stiffness = {.has_helper = false}})),
        servo_(link, hand.limits(), {}) {
    for (double rested = 0; rested < 1; rested += frame) session.step_frame();  // until the body has sagged
  }
  ~VirtualLoop() { hook_.reset(); }

  void take_hold() { controller.send(take_at(top)); }
  void stall(double seconds) { next_frame_ += seconds; }  // no frame for so long

  // each(state) after every tick, for so long.
  template <class Each>
  void run(double seconds, Each&& each) {
    constexpr double tick = 1e-3;
    for (const double end = now_ + seconds - 0.5 * tick; now_ < end; now_ += tick) {
      while (now_ >= next_frame_ - 1e-9) {
        session.step_frame();
        next_frame_ += session.frame();
      }
      DeviceState state;
      const bool is_there = hand.read(state);
      if (change) change(state);
      const HapticState& felt = servo_.force(is_there ? &state : nullptr, tick);
      hand.write(felt.force, felt.torque);
      position_ = state.position;
      last_ = felt;
      each(felt);
    }
  }

  struct Seen {
    const HapticState& state() const { return of; }
    const HapticState& of;
  };
  Seen servo() const { return {last_}; }
  struct Energy {
    double given = 0, stored = 0;  // to the hand; the most that it has given before [J]
  };
  Energy energy_over(double seconds) {
    Energy energy;
    std::optional<HapticState> before;
    run(seconds, [&](const HapticState& state) {
      if (before) energy.given += before->force.dot(state.device.position - before->device.position);
      energy.stored = std::max(energy.stored, -energy.given);
      before = state;
    });
    return energy;
  }
  const Vec3d& hand_position() const { return position_; }

  const Setup setup;
  Session<float> session;
  Controller controller;
  HapticLink link;
  SimulatedHand hand;
  std::function<void(DeviceState&)> change;  // of what the device says

 private:
  std::unique_ptr<HapticHand<float>> hook_;
  ExternalDevice servo_;
  HapticState last_;
  Vec3d position_ = Vec3d::Zero();
  double now_ = 0, next_frame_ = 0;
};

}  // namespace lobe::test
