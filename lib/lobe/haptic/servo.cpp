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

const ServoOptions& checked(const ServoOptions& options) {
  const Workspace& space = options.workspace;
  expect(is_above_0(options.tick), "haptic tick", "must be above 0 s, and finite");
  expect(is_above_0(options.bound_share), "haptic coupling", "must be a share of the bound above 0");
  expect(options.coupling_damping >= 0 && options.coupling_damping <= 0.25, "haptic coupling damping",
         "must be a share from 0 to a quarter of the device's");
  expect(options.longest_blend >= 0 && is_above_0(options.blend_rate) && options.stale_frames >= 1 &&
             is_above_0(options.fade) && options.settling_frames >= 0,
         "haptic blending", "takes no negative times, a rate above 0, and models last a frame at least");
  expect(options.highest_damping >= 0 && options.passivity_deadband >= 0 &&
             options.most_active >= options.passivity_deadband,
         "haptic passivity controller", "must not have negative damping or energy");
  expect(is_above_0(space.scale) && is_above_0(space.force_gain), "haptic workspace",
         "its scale and force gain must be above 0, and finite");
  expect(space.origin.allFinite() && space.rotation.allFinite(), "haptic workspace", "must be finite");
  expect((space.rotation.transpose() * space.rotation - Mat3<double>::Identity()).norm() < 1e-6 &&
             space.rotation.determinant() > 0,
         "haptic workspace", "its rotation must be orthogonal, and no mirror");
  return options;
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
      options_(checked(options)),
      damping_(options.coupling_damping * limits.damping),
      device_turn_(Eigen::Quaterniond::Identity()),
      tool_turn_(Eigen::Quaterniond::Identity()),
      passivity_(limits.damping, options.highest_damping, options.passivity_deadband) {
  const Workspace& space = options.workspace;
  const double bound = passive_stiffness(limits.damping, damping_, options.tick);
  state_.coupling = std::min(limits.stiffness, options.bound_share * bound);
  coupling_ = state_.coupling / (space.scale * space.force_gain);
}

Vec3d Servo::tool_of(const Vec3d& device) const {
  return options_.workspace.origin + options_.workspace.scale * (options_.workspace.rotation * device) +
         clutch_;
}

// By how much the device has turned since the tool was taken up, seen in the workspace, goes on top of the
// tool's orientation then. A device that is held aslant turns nothing.
Eigen::Quaterniond Servo::turn_of_tool() const {
  Eigen::Quaterniond turn = Eigen::Quaterniond(state_.device.orientation) * device_turn_.conjugate();
  turn.vec() = options_.workspace.rotation * turn.vec();
  return turn * tool_turn_;
}

const HapticState& Servo::tick(const DeviceState* device, const LocalModel& model, double dt) {
  ++state_.ticks;
  since_model_ += dt;
  take_pose(device, dt);
  take_model(model, dt);
  if (awaits_pose_ && is_fresh_ && model_.is_engaged) take_up(model_);
  const Vec3d force = wanted_force(dt);
  const Vec3d torque = trust_ * (options_.workspace.rotation.transpose() * model_.torque);
  send(force, torque, dt);
  return state_;
}

// While there is no pose the hand is taken to be where it was seen last. Its first pose after that stands for
// this place: it may have been moved while it was unplugged.
void Servo::take_pose(const DeviceState* device, double dt) {
  const bool was_fresh = is_fresh_;
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
  const Vec3d before = tool_of(state_.device.position);
  const Eigen::Quaterniond turn_before = turn_of_tool();
  state_.device = *device;
  if (!was_fresh && model_.is_engaged) begin_here(before, turn_before);
}

// The device, where it is, stands for this pose of the tool.
void Servo::begin_here(const Vec3d& position, const Eigen::Quaterniond& turn) {
  clutch_ += position - tool_of(state_.device.position);
  device_turn_ = Eigen::Quaterniond(state_.device.orientation);
  tool_turn_ = turn;
}

// The tool is where it is. If the device has no pose yet, its first one is where it takes the tool up.
void Servo::take_up(const LocalModel& model) {
  begin_here(model.tool_at_end, Eigen::Quaterniond(model.turn_at_end));
  state_.tool = proxy_ = unloaded_ = model.tool_at_end;
  settled_.setZero();
  awaits_pose_ = !is_fresh_;
}

// Blending begins with the tick in which a model comes: where each tick has one, there is none.
void Servo::take_model(const LocalModel& model, double dt) {
  const bool is_new = model.time != model_.time || model.engagement != model_.engagement ||
                      model.is_engaged != model_.is_engaged;
  if (!is_new) return;
  const Vec3d was = model_.is_engaged ? force_at(aged(model_, since_model_), proxy_) : Vec3d::Zero();
  if (model.is_engaged && (!model_.is_engaged || model.engagement != model_.engagement)) take_up(model);
  const Vec3d is = model.is_engaged ? force_at(aged(model, dt), proxy_) : Vec3d::Zero();
  offset_ = was + blended_ - is;
  const double shortest = options_.workspace.force_gain * offset_.norm() / options_.blend_rate;
  blend_ = std::min({model.frame, options_.longest_blend, shortest});
  model_ = model;
  since_model_ = dt;
}

// The force is held until the next tick, half a tick late in the mean, which would give the hand energy. So
// it is found for where the device will be then, as far as Colgate's bound allows: of a stiffness K this is
// damping of K times the time.
double Servo::lead() const {
  const double tissue = model_.K.norm();  // no eigenvalue is above it
  const double felt = options_.workspace.scale * options_.workspace.force_gain * coupling_ *
                      (model_.is_bilateral ? tissue / (coupling_ + tissue) : 1);
  const double half = 0.5 * options_.tick;
  if (!is_fresh_ || felt == 0) return 0;
  return std::clamp((limits_.damping - damping_) / felt - half, 0.0, half);
}

// At most what the coupling, and tissue that has been loaded from nothing to `force`, have stored [J].
double Servo::storable(const Vec3d& force) const {
  const double of_tissue = force.norm() * (proxy_ - unloaded_).norm();
  return 0.5 * (force.squaredNorm() / coupling_ + of_tissue);
}

// The tool follows the device at once, and the yielding of the coupling slowly. Where it followed the force
// of the last frame at once, a body that swings in the hand would swing ever higher, since the force comes
// a frame late.
void Servo::settle(const Vec3d& device, double dt) {
  const double share = dt / (options_.settling_frames * model_.frame + dt);
  settled_ += share * (proxy_ - device - settled_);
  state_.tool = device + settled_;
}

// While a force fades, the hand can move against it for nothing: then the observer begins again. Where
// damping is not enough, as when a body that swings answers a frame late, the force itself is lowered until
// no energy comes out.
void Servo::limit_activity(double storable, double dt) {
  passivity_.forget_above(storable);
  if (trust_ < 1) passivity_.restart(storable);
  const bool is_too_active = options_.highest_damping > 0 && passivity_.energy() < -options_.most_active;
  share_ = std::clamp(share_ + (is_too_active ? -dt / options_.fade : dt), 0.0, 1.0);
  passivity_.forget_debts(dt);
}

Vec3d Servo::wanted_force(double dt) {
  const double left = blend_ > 0 ? std::max(0.0, 1 - since_model_ / blend_) : 0;
  blended_ = left * offset_;
  const Vec3d device = tool_of(state_.device.position + lead() * state_.device.velocity);
  const Proxy proxy = model_.is_engaged
                          ? quasi_static_proxy(aged(model_, since_model_), device, coupling_, blended_)
                          : Proxy{device, blended_};
  proxy_ = proxy.position;
  if (proxy.force.isZero(0)) unloaded_ = proxy_;
  if (is_fresh_) settle(device, dt);
  state_.orientation = turn_of_tool().coeffs();
  state_.engagement = model_.is_engaged ? model_.engagement : 0;
  const bool is_stale = since_model_ > options_.stale_frames * model_.frame;
  state_.stale += is_stale && model_.is_engaged;
  const double fading = dt / options_.fade;
  trust_ = std::clamp(trust_ + (is_stale || !is_fresh_ ? -fading : fading), 0.0, 1.0);
  const bool is_gone = is_stale && model_.is_engaged && trust_ == 0;
  state_.stalls += is_gone && !was_gone_;
  was_gone_ = is_gone;

  const Workspace& space = options_.workspace;
  const Vec3d felt = space.force_gain * (space.rotation.transpose() * proxy.force);
  limit_activity(2 * storable(proxy.force) * space.force_gain / space.scale, dt);
  Vec3d force = trust_ * share_ * (felt - (model_.is_engaged ? damping_ : 0.0) * state_.device.velocity);
  const double damping = passivity_.damping(state_.device.velocity, dt);
  force -= damping * state_.device.velocity;
  state_.interventions += damping > 0 || share_ < 1;
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
