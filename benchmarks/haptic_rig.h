// Haptic loops in virtual time: a tool on a given path, frames of any length, and what different predictions
// between two frames say, against the same body in frames of 1 ms.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lobe/haptic/contact_stiffness.h"
#include "lobe/haptic/servo.h"
#include "lobe/sim/world.h"

namespace lobe::bench {

// A hand's way from where it takes hold: offsets [m] at times [s], with smooth speeds.
struct HandPath {
  struct Leg {
    Vec3d to;         // [m]
    double speed;     // the highest on the way [m/s]; 0: it rests for `rest`
    double rest = 0;  // [s]
  };
  std::vector<Leg> legs;

  static double length(const Leg& leg, const Vec3d& from) {
    // A quintic, whose highest speed is 15/8 of its mean.
    return leg.speed > 0 ? 1.875 * (leg.to - from).norm() / leg.speed : leg.rest;
  }
  double duration() const {
    double sum = 0;
    Vec3d from = Vec3d::Zero();
    for (const Leg& leg : legs) {
      sum += length(leg, from);
      if (leg.speed > 0) from = leg.to;
    }
    return sum;
  }
  Vec3d at(double time) const {
    Vec3d from = Vec3d::Zero();
    for (const Leg& leg : legs) {
      const double whole = length(leg, from);
      if (time < whole && leg.speed > 0) {
        const double s = std::max(0.0, time / whole);
        return from + s * s * s * (10 - 15 * s + 6 * s * s) * (leg.to - from);
      }
      if (time < whole) return from;
      time -= whole;
      if (leg.speed > 0) from = leg.to;
    }
    return from;
  }
};

// Presses, holds, slides, pulls and comes back: `in` is the unit way into the body, `along` one on its
// surface.
inline HandPath press_and_pull(const Vec3d& in, const Vec3d& along, double depth, double speed) {
  return {{{depth * in, speed},
           {Vec3d::Zero(), 0, 0.1},
           {depth * in + depth * along, speed},
           {depth * along, speed},
           {-0.7 * depth * in + depth * along, speed},
           {Vec3d::Zero(), 0, 0.1},
           {Vec3d::Zero(), speed}}};
}

struct FeltFrame {
  double end = 0;                  // [s]
  Vec3d position = Vec3d::Zero();  // mean of the frame, an offset [m]
  Vec3d force = Vec3d::Zero();     // on the tool, mean of the frame [N]
  Vec3d rate = Vec3d::Zero();      // of the force, beside K [N/s]
  Mat3<double> blocked = Mat3<double>::Zero(), patch = blocked, K = blocked;  // [N/m]
  bool is_bilateral = true;       // false: the tool only pushes, along the normal
  Vec3d normal = Vec3d::UnitZ();  // then
};

// The forces on a tool that holds `vertices` along a path, frame by frame.
inline std::vector<FeltFrame> feel(const Setup& setup, const std::vector<Index>& vertices,
                                   const HandPath& path, double frame, bool finds_stiffness) {
  World<float> world(setup);
  const ToolId tool = world.tools().next_id();
  world.apply(TakeHold{"hand", vertices});
  world.advance(frame);
  const Vec3d centre = world.tools().grasp(tool)->centre;
  ContactStiffness stiffness({.every = 0.025, .has_helper = false});
  ContactPatch patch;
  std::vector<FeltFrame> frames;
  const int count = static_cast<int>(std::ceil(path.duration() / frame));
  for (int i = 0; i < count; ++i) {
    const Vec3d from = path.at(i * frame), to = path.at((i + 1) * frame);
    world.apply(Lead{tool, {centre + to}});
    world.advance(frame);
    FeltFrame felt{.end = (i + 1) * frame, .position = 0.5 * (from + to)};
    felt.force = -world.tools().grasp(tool)->force;
    if (finds_stiffness) {
      const auto u = world.displacements();
      const auto displacement = [&](Index v) -> Vec3d { return u.col(v).template cast<double>(); };
      stiffness.after_frame(world.body().model, vertices, displacement, felt.position, felt.force, frame);
      felt.K = stiffness.K();
      felt.rate = stiffness.rate();
      const double reach =
          frame * shear_speed(world.elements(), world.elements().topology.around(vertices.front()).front());
      patch.gather(world.body().model, vertices, displacement, {.reach = reach});
      felt.blocked = patch.blocked();
      felt.patch = patch.condense();
    }
    frames.push_back(felt);
  }
  return frames;
}

// Linear between the middles of the frames.
inline Vec3d force_of(const std::vector<FeltFrame>& frames, double time) {
  const double frame = frames.front().end;
  const double at = std::clamp(time / frame - 0.5, 0.0, double(frames.size()) - 1.001);
  const auto i = static_cast<std::size_t>(at);
  return frames[i].force + (at - double(i)) * (frames[i + 1].force - frames[i].force);
}

struct PredictionError {
  double rms = 0, highest = 0;  // shares of the highest force; rms while either force is not 0
  double jump = 0;              // the largest between two ticks, beyond that of the reference; same share
  double peak = 0;              // the highest force [N]
};

// predict(k, time): from frame k, the last that is known.
using Predict = std::function<Vec3d(std::size_t k, double time)>;

inline PredictionError error_of(const std::vector<FeltFrame>& frames, const std::vector<FeltFrame>& reference,
                                double delay, double tick, const Predict& predict) {
  const double frame = frames.front().end;
  PredictionError error;
  double squares = 0;
  int count = 0;
  bool is_first = true;
  Vec3d before = Vec3d::Zero(), exact_before = Vec3d::Zero();
  for (const FeltFrame& felt : reference) error.peak = std::max(error.peak, felt.force.norm());
  for (int i = 0;; ++i) {
    const double time = i * tick;
    if (time >= frames.back().end) break;
    const double known = (time - delay) / frame + 1e-9;
    const Vec3d predicted = predict(static_cast<std::size_t>(std::max(0.0, known)), time);
    if (known < 2) continue;
    const Vec3d exact = force_of(reference, time);
    const double off = (predicted - exact).norm();
    const bool is_free = exact.isZero(0) && predicted.isZero(0);
    squares += off * off;
    error.highest = std::max(error.highest, off);
    if (!is_first) error.jump = std::max(error.jump, (predicted - before - (exact - exact_before)).norm());
    before = predicted;
    exact_before = exact;
    is_first = false;
    count += !is_free;
  }
  error.rms = std::sqrt(squares / count) / error.peak;
  error.highest /= error.peak;
  error.jump /= error.peak;
  return error;
}

// ---- Predictions: frame k is known (k ≥ 1 of them have ended), so the last is frames[k − 1].

inline Predict constant(const std::vector<FeltFrame>& frames) {
  return [&](std::size_t k, double) -> Vec3d { return k == 0 ? Vec3d(Vec3d::Zero()) : frames[k - 1].force; };
}

inline Predict linear_in_time(const std::vector<FeltFrame>& frames) {
  return [&](std::size_t k, double time) -> Vec3d {
    if (k < 2) return Vec3d::Zero();
    const FeltFrame &last = frames[k - 1], &former = frames[k - 2];
    const double frame = last.end - former.end, since = time - (last.end - 0.5 * frame);
    return last.force + since / frame * (last.force - former.force);
  };
}

// [PDA] reference [15]: along the tool's last motion, but no further than 1.5 times that, as far as linear in
// time goes. After a rest the last motion is tiny, and what it says about further places is worth nothing.
inline Predict linear_in_position(const std::vector<FeltFrame>& frames, const HandPath& path) {
  return [&](std::size_t k, double time) -> Vec3d {
    if (k < 2) return Vec3d::Zero();
    const FeltFrame &last = frames[k - 1], &former = frames[k - 2];
    const Vec3d d = last.position - former.position;
    if (d.norm() < 1e-6) return last.force;
    const double share = std::clamp((path.at(time) - last.position).dot(d) / d.squaredNorm(), -1.5, 1.5);
    return last.force + share * (last.force - former.force);
  };
}

// f_k − K (x − x_k), without blending.
inline Predict by_stiffness(const std::vector<FeltFrame>& frames, const HandPath& path,
                            const std::function<Mat3<double>(std::size_t)>& K) {
  return [&frames, &path, K](std::size_t k, double time) -> Vec3d {
    if (k == 0) return Vec3d::Zero();
    const FeltFrame& last = frames[k - 1];
    return last.force - K(k - 1) * (path.at(time) - last.position);
  };
}

// Of frame k. The tool's end of the frame is not known here.
inline LocalModel model_of(const FeltFrame& felt, double frame) {
  return {.is_engaged = true,
          .engagement = 1,
          .is_bilateral = felt.is_bilateral,
          .frame = frame,
          .time = felt.end,
          .tool_at_end = felt.position,
          .position = felt.position,
          .force = felt.force,
          .rate = felt.rate,
          .K = felt.K,
          .normal = felt.normal};
}

// The local model as it stands, without its rate and without blending.
inline Predict by_local_model(const std::vector<FeltFrame>& frames, const HandPath& path) {
  return [&](std::size_t k, double time) -> Vec3d {
    if (k == 0) return Vec3d::Zero();
    return force_at(model_of(frames[k - 1], frames.front().end), path.at(time));
  };
}

// The servo itself on a device that is as stiff as need be: with blending, as the hand feels it.
inline Predict by_servo(const std::vector<FeltFrame>& frames, const HandPath& path, double tick) {
  const DeviceLimits rigid{.force = 1e6, .torque = 1, .slew = 1e9, .stiffness = 1e7, .damping = 1e9};
  auto servo = std::make_shared<Servo>(rigid, ServoOptions{.tick = tick, .highest_damping = 0});
  const double frame = frames.front().end;
  return [&frames, &path, tick, frame, servo](std::size_t k, double time) -> Vec3d {
    LocalModel model{.frame = frame};
    if (k > 0) {
      model = model_of(frames[k - 1], frame);
      model.tool_at_end = path.at(time);
    }
    const DeviceState device{.position = path.at(time)};
    return servo->tick(&device, model, tick).force;
  };
}

}  // namespace lobe::bench
