// The link between the thread of a session and that of a haptic loop. Each reads the latest value of the
// other. Neither waits.
#pragma once

#include "lobe/haptic/servo.h"
#include "lobe/snapshot/triple_buffer.h"

namespace lobe {

struct HapticLink {
  TripleBuffer<LocalModel> model;   // models from the session, one per frame
  TripleBuffer<HapticState> state;  // states from the loop, one per tick
};

// A servo with its link, driven by whoever calls tick().
class LinkedServo {
 public:
  LinkedServo(HapticLink& link, const DeviceLimits& limits, const ServoOptions& options)
      : link_(link), servo_(limits, options) {}

  // Looks for a new model. Returns where its tool is if the next tick takes up another tool; else null.
  const Vec3d* new_tool() {
    const LocalModel before = model_;
    if (const auto latest = link_.model.latest()) model_ = *latest;
    const bool is_new = !before.is_engaged || before.engagement != model_.engagement;
    return model_.is_engaged && is_new ? &model_.tool_at_end : nullptr;
  }

  const HapticState& tick(const DeviceState* device, double dt) {
    if (const auto latest = link_.model.latest()) model_ = *latest;
    return tick_with_model(device, dt);
  }

  // Ticks with the model that new_tool() has seen.
  const HapticState& tick_with_model(const DeviceState* device, double dt) {
    const HapticState& state = servo_.tick(device, model_, dt);
    if (HapticState* shared = link_.state.writable()) {
      *shared = state;
      link_.state.publish();
    }
    return state;
  }

 private:
  HapticLink& link_;
  Servo servo_;
  LocalModel model_;
};

}  // namespace lobe
