#include "lobe/haptic/haptic_hand.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/error.h"
#include "lobe/haptic/approach.h"

namespace lobe {

using Kind = HandCommand::Kind;

template <class Real>
HapticHand<Real>::HapticHand(Session<Real>& session, HapticLink& link, const Settings& settings)
    : session_(session), link_(link), settings_(settings), stiffness_(settings.stiffness) {
  if (settings.controller < 0) made_controller_.emplace(session.connect("haptic"));
  controller_ = made_controller_ ? made_controller_->number() : settings.controller;
  // The loop takes up the first tool of this hand, whatever the hand before it held.
  if (const auto former = link.model.latest()) engagement_ = former->engagement;
  session.between_frames([&] { session.add_hook(*this); });
}

template <class Real>
HapticHand<Real>::~HapticHand() {
  session_.between_frames([&] {
    session_.remove_hook(*this);
    publish({.engagement = engagement_});
  });
}

template <class Real>
void HapticHand<Real>::publish(const LocalModel& model) {
  if (LocalModel* shared = link_.model.writable()) {
    *shared = model;
    link_.model.publish();
  }
}

// ---- Before a frame

template <class Real>
void HapticHand<Real>::press_buttons(Hands<Real>& hands, const HapticState& state) {
  const bool pressed = state.is_there && (state.device.buttons & 1u) != 0;
  if (pressed == is_pressed_) return;
  is_pressed_ = pressed;
  try {
    hands.perform_command(controller_, {.kind = pressed ? Kind::take_at_point : Kind::let_go,
                                        .hand = settings_.hand,
                                        .position = state.tool,
                                        .radius = settings_.radius});
  } catch (const InputError& error) {
    hands.say("refused", std::string("haptic: ") + error.what());
  }
}

template <class Real>
void HapticHand<Real>::tell_troubles(Hands<Real>& hands, const HapticState& state) {
  if (last_.is_there && !state.is_there)
    hands.say("haptic_gone", "the haptic device does not answer: its force fades");
  const bool is_bad = state.bad_poses > last_.bad_poses;
  if (is_bad && !was_bad_)
    hands.say("haptic_pose",
              "the haptic device has sent a pose that is not finite: it was left out, and the force fades");
  if (state.stalls > last_.stalls)
    hands.say("haptic_stale",
              "the simulation came to no frame for so long that the force of the haptic device was gone: it "
              "comes back");
  was_bad_ = is_bad;
  last_ = state;
}

template <class Real>
void HapticHand<Real>::before_frame(Hands<Real>& hands, World<Real>&, double) {
  const auto state = link_.state.latest();
  if (state) {
    tell_troubles(hands, *state);
    if (made_controller_) press_buttons(hands, *state);
  }
  const auto led_tool = hands.led_tool(controller_, settings_.hand);
  before_ = led_tool.pose.position;
  if (!state || led_tool.tool == 0 || !model_.is_engaged || state->engagement != model_.engagement) return;
  if (state->is_there) hands.place(controller_, settings_.hand, {state->tool, state->orientation});
}

// ---- After it

namespace {

constexpr double least_push = 1e-3;  // with which a tool is said to touch [N]
// Of a tool that only touches, the share of the patch that counts before a motion has said how stiff it is.
// All vertices near its tip are taken to move with it, but at first it touches few: the whole patch, three to
// six times too stiff, would give a blow. A fast press comes to it within a frame. A slow one does not come
// as deep, and is less stiff: of a round tip, as Hertz says.
constexpr double first_share = 0.25;

// Of any kind of tool: what the body does to it in the mean of the last frame.
struct Felt {
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  bool only_pushes = false;  // it holds nothing
  double radius = 0;         // of its tip [m]
  double opening = 0;        // of jaws [m]
  const RigidShape* probe = nullptr;
};
template <class Real>
Felt felt_by(const World<Real>& world, ToolId id) {
  Felt felt;
  world.tools().visit(id, [&](const auto& tool) {
    if constexpr (requires {
                    tool.force;
                    tool.torque;
                  }) {
      felt.force = -tool.force;
      felt.torque = -tool.torque;
    }
    if constexpr (requires { tool.grip; }) felt.only_pushes = tool.grip == 0;
    if constexpr (requires { tool.core_path; }) felt.only_pushes = tool.core.radius > 0;
    if constexpr (requires { tool.shape_of_tip; }) felt.probe = &tool.shape_of_tip;
    const ToolShape shape = tool.shape();
    felt.radius = shape.radius;
    felt.opening = shape.opening;
  });
  return felt;
}

template <class Real>
std::vector<Index> held_by(const World<Real>& world, ToolId tool) {
  std::vector<Index> vertices;
  for (const HeldVertices::Held& item : world.held().all())
    if (item.holder == tool) vertices.push_back(item.vertex);
  return vertices;
}

// dF/dδ of Hertz' force 4/3 E* √(R δ³), E* = E/(1 − ν²), of a sphere on a half-space [N/m].
double hertz_stiffness(const Elastic& elastic, double radius, double depth) {
  const double lambda = elastic.lambda, mu = elastic.mu;
  return 8 * mu * (lambda + mu) / (lambda + 2 * mu) * std::sqrt(radius * depth);
}

template <class Real>
ExpectedStiffness expected_of(const World<Real>& world, const Felt& felt, const Vec3d& normal,
                              std::span<const Index> contact, std::optional<double> depth) {
  ExpectedStiffness expected{.share = felt.only_pushes ? first_share : 1, .normal = normal};
  using Shape = RigidShape::Kind;
  if (!depth || !felt.probe || contact.empty()) return expected;
  if (felt.probe->kind != Shape::sphere && felt.probe->kind != Shape::capsule) return expected;
  const auto around = world.elements().topology.around(contact.front());
  if (!around.empty())
    expected.most =
        hertz_stiffness(world.elements().elastic_of(around.front()).at_once(), felt.radius, *depth);
  return expected;
}

// Vertices of the surface within a radius of a point; where there are none, the nearest.
template <class Real>
std::vector<Index> near_tip(World<Real>& world, const Vec3d& tip, double radius) {
  const auto u = world.displacements();
  const auto X = world.elements().points.view();
  std::vector<Index> vertices;
  Index nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (Index v : world.surface().mesh().mesh_vertex) {
    if (world.held().fixes(v)) continue;
    const double distance = (X.col(v) + u.col(v).template cast<double>() - tip).norm();
    if (distance <= radius) vertices.push_back(v);
    if (distance < least) least = distance, nearest = v;
  }
  if (vertices.empty() && nearest >= 0) vertices.push_back(nearest);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

// Where a tool that feels nothing will begin to touch, if that is so near that it may be before the next
// frame is known. From there the model is a plane as stiff as is expected, so that the hand feels it at once.
template <class Real>
void HapticHand<Real>::look_ahead(World<Real>& world, const RigidShape& shape, double opening,
                                  const ToolPose& pose) {
  constexpr double frames_ahead = 3, at_least = 1e-3;  // [m]
  const double reach = std::max(at_least, frames_ahead * (pose.position - before_).norm());
  const auto found = approach_of(world, shape, opening, pose, reach);
  if (!found) return;
  const double gap = std::max(0.0, found->gap);  // it feels nothing where it is
  touch_ = pose.position - gap * found->normal;
  model_.normal = found->normal;
  model_.position = *touch_;
}

// In the frame in which it begins, a tool touches for a part of the time. Of contact whose force grows in
// proportion to the depth, the mean force of the frame is that at a place of its own:
//   D²/(2 W) deep,   D the depth at the end, W ≥ D the way of the frame.
// If it has touched all the time, that is its mean place, D − W/2 deep.
template <class Real>
void HapticHand<Real>::place_first_touch(const Vec3d& at_end) {
  constexpr double least_depth = 2e-4;  // that says how stiff the contact is [m]
  const auto depth_of = [&](const Vec3d& x) { return -model_.normal.dot(x - *touch_); };
  const double end = depth_of(at_end), way = end - depth_of(before_);
  if (!(end > 0)) return;
  const double depth = way > end ? end * end / (2 * way) : end - way / 2;
  model_.position -= (depth - depth_of(model_.position)) * model_.normal;
  if (depth >= least_depth) stiffness_.begin_at(model_.position + depth * model_.normal);
}

// At the end of the next frame, if the tool goes on [m].
template <class Real>
double HapticHand<Real>::depth_to_come(const Vec3d& at_end) const {
  const double way = std::abs(model_.normal.dot(at_end - before_));
  return std::max(way, way - model_.normal.dot(at_end - *touch_));
}

template <class Real>
void HapticHand<Real>::feel(World<Real>& world, ToolId tool, const ToolPose& pose, double duration) {
  const Felt felt = felt_by(world, tool);
  const bool is_felt = felt.force.norm() > least_push;
  model_.force = felt.force;
  model_.torque = felt.torque;
  model_.is_bilateral = !felt.only_pushes;
  std::optional<double> depth;
  if (felt.only_pushes && is_felt) {
    if (touch_) place_first_touch(pose.position);
    model_.normal = felt.force.normalized();
    if (touch_) depth = depth_to_come(pose.position);
  }
  touch_.reset();
  if (felt.only_pushes && !is_felt && felt.probe) look_ahead(world, *felt.probe, felt.opening, pose);
  if (touch_) depth = depth_to_come(pose.position);
  std::vector<Index> contact;
  if (!felt.only_pushes) contact = held_by(world, tool);
  if (contact.empty() && (is_felt || touch_))
    contact = near_tip(world, touch_ ? *touch_ : pose.position, 1.5 * felt.radius);
  const auto u = world.displacements();
  const auto displacement = [&](Index v) -> Vec3d { return u.col(v).template cast<double>(); };
  const ExpectedStiffness expected = expected_of(world, felt, model_.normal, contact, depth);
  if (touch_)
    stiffness_.before_touch(world.body().model, contact, displacement, duration, expected);
  else
    stiffness_.after_frame(world.body().model, contact, displacement, model_.position, model_.force, duration,
                           expected);
  model_.K = stiffness_.K();
  model_.rate = felt.only_pushes ? stiffness_.rate_of_push(model_.normal) : stiffness_.rate();
}

template <class Real>
void HapticHand<Real>::after_frame(Hands<Real>& hands, World<Real>& world, double duration) {
  const auto led_tool = hands.led_tool(controller_, settings_.hand);
  const bool is_same = led_tool.tool != 0 && led_tool.tool == tool_;
  if (!is_same) {
    stiffness_.forget();
    touch_.reset();
    tool_ = led_tool.tool;
    engagement_ += led_tool.tool != 0;
    model_ = {.engagement = engagement_};
    before_ = led_tool.pose.position;
  }
  model_.is_engaged = led_tool.tool != 0;
  model_.frame = duration;
  model_.time = world.time();
  if (led_tool.tool != 0) {
    model_.tool_at_end = led_tool.pose.position;
    model_.turn_at_end = led_tool.pose.orientation;
    model_.position = 0.5 * (before_ + led_tool.pose.position);
    feel(world, led_tool.tool, led_tool.pose, duration);
  }
  publish(model_);
}

template class HapticHand<float>;
template class HapticHand<double>;

}  // namespace lobe
