#include "lobe/haptic/servo.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/error.h"

namespace lobe {
namespace {

bool is_above_0(double value) { return value > 0 && std::isfinite(value); }

void expect(bool is_right, const std::string& place, const char* what) {
  if (!is_right) throw InputError(place, what);
}

const ServoOptions& checked(const ServoOptions& options, const DeviceLimits& limits) {
  const Workspace& space = options.workspace;
  expect(is_above_0(options.tick), "haptic tick", "must be above 0 s, and finite");
  expect(is_above_0(options.bound_share), "haptic coupling", "must be a share of the bound above 0");
  expect(options.coupling_damping >= 0 && options.coupling_damping <= limits.damping / 4,
         "haptic coupling damping", "must be from 0 to a quarter of the device's");
  expect(options.longest_blend >= 0 && options.stale_frames >= 1 && is_above_0(options.fade),
         "haptic blending", "takes no negative times, and models last a frame at least");
  expect(options.highest_damping >= 0, "haptic passivity controller", "must not have negative damping");
  expect(is_above_0(space.scale) && is_above_0(space.force_gain), "haptic workspace",
         "its scale and force gain must be above 0, and finite");
  expect(space.origin.allFinite() && space.turn.allFinite(), "haptic workspace", "must be finite");
  expect((space.turn.transpose() * space.turn - Mat3<double>::Identity()).norm() < 1e-6, "haptic workspace",
         "its turn must be orthogonal");
  return options;
}

// That springs of these stiffnesses can store under a force [J].
double stored_energy(const Vec3d& force, const Mat3<double>& K, double coupling) {
  const Mat3<double> softened = K + 1e-3 * coupling * Mat3<double>::Identity();
  return 0.5 * (force.squaredNorm() / coupling + force.dot(softened.inverse() * force));
}

}  // namespace

void check(const DeviceLimits& limits, const std::string& device) {
  expect(is_above_0(limits.force) && is_above_0(limits.torque) && is_above_0(limits.slew), device,
         "its highest force, torque and slew must be above 0, and finite");
  expect(is_above_0(limits.stiffness) && is_above_0(limits.damping), device,
         "its stiffness and damping must be above 0, and finite");
}

Servo::Servo(const DeviceLimits& limits, const ServoOptions& options)
    : limits_((check(limits, "haptic device"), limits)),
      options_(checked(options, limits)),
      passivity_(limits.damping, options.highest_damping) {
  const Workspace& space = options.workspace;
  const double bound = passive_stiffness(limits.damping, options.coupling_damping, options.tick);
  state_.coupling = std::min(limits.stiffness, options.bound_share * bound);
  coupling_ = state_.coupling / (space.scale * space.force_gain);
}

Vec3d Servo::tool_of(const Vec3d& device) const {
  return options_.workspace.origin + options_.workspace.scale * (options_.workspace.turn * device) + clutch_;
}

const HapticState& Servo::tick(const DeviceState* device, const LocalModel& model, double dt) {
  ++state_.ticks;
  since_model_ += dt;
  take_pose(device, dt);
  take_model(model, dt);
  const Vec3d force = wanted_force(dt);
  const Vec3d torque = trust_ * (options_.workspace.turn.transpose() * model_.torque);
  send(force, torque, dt);
  return state_;
}

// While there is no pose the hand is taken to be where it was seen last.
void Servo::take_pose(const DeviceState* device, double dt) {
  is_fresh_ = device != nullptr && device->is_finite();
  state_.absent += device == nullptr;
  state_.bad_poses += device != nullptr && !is_fresh_;
  const bool was_there = std::exchange(state_.is_there, device != nullptr);
  if (!is_fresh_) {
    state_.device.velocity.setZero();
    return;
  }
  if (was_there && state_.ticks > 1)
    passivity_.observe(state_.force, device->position - state_.device.position, dt);
  state_.device = *device;
}

// Blending begins with the tick in which a model comes: where each tick has one, there is none.
void Servo::take_model(const LocalModel& model, double dt) {
  const bool is_new = model.time != model_.time || model.engagement != model_.engagement ||
                      model.is_engaged != model_.is_engaged;
  if (!is_new) return;
  const Vec3d was = model_.is_engaged ? force_at(model_, state_.tool) : Vec3d::Zero();
  if (model.is_engaged && (!model_.is_engaged || model.engagement != model_.engagement)) {
    clutch_ += model.anchor - tool_of(state_.device.position);
    state_.tool = model.anchor;  // another one, which is there
  }
  const Vec3d is = model.is_engaged ? force_at(model, state_.tool) : Vec3d::Zero();
  offset_ = was + blended_ - is;
  model_ = model;
  since_model_ = dt;
}

Vec3d Servo::wanted_force(double dt) {
  const double blend = std::min(model_.frame, options_.longest_blend);
  const double left = blend > 0 ? std::max(0.0, 1 - since_model_ / blend) : 0;
  blended_ = left * offset_;
  const Vec3d device = tool_of(state_.device.position);
  const Proxy proxy =
      model_.is_engaged ? quasi_static_proxy(model_, device, coupling_, blended_) : Proxy{device, blended_};
  state_.tool = proxy.position;
  state_.orientation = state_.device.orientation;
  state_.engagement = model_.is_engaged ? model_.engagement : 0;
  state_.model_age = since_model_;
  const bool is_stale = since_model_ > options_.stale_frames * model_.frame;
  state_.stale += is_stale && model_.is_engaged;
  const double fading = dt / options_.fade;
  trust_ = std::clamp(trust_ + (is_stale || !is_fresh_ ? -fading : fading), 0.0, 1.0);

  const Workspace& space = options_.workspace;
  const Vec3d felt = space.force_gain * (space.turn.transpose() * proxy.force);
  passivity_.forget_above(
      2 * stored_energy(proxy.force, model_.is_engaged ? model_.K : Mat3<double>::Zero(), coupling_) *
      space.force_gain / space.scale);
  Vec3d force = trust_ * (felt - options_.coupling_damping * state_.device.velocity);
  if (const double damping = passivity_.damping(state_.device.velocity, dt); damping > 0) {
    force -= damping * state_.device.velocity;
    ++state_.interventions;
  }
  state_.energy = passivity_.energy();
  return force;
}

void Servo::send(const Vec3d& force, const Vec3d& torque, double dt) {
  Vec3d bounded = force;
  if (const double size = force.norm(); size > limits_.force) bounded *= limits_.force / size;
  const double step = limits_.slew * dt;
  const Vec3d change = bounded - state_.force;
  if (const double size = change.norm(); size > step) bounded = state_.force + change * (step / size);
  state_.limited += bounded != force;
  state_.force = bounded;
  state_.torque = torque;
  if (const double size = torque.norm(); size > limits_.torque) state_.torque *= limits_.torque / size;
}

}  // namespace lobe
