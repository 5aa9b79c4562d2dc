#include "lobe/haptic/haptic_hand.h"

#include <algorithm>
#include <limits>

#include "lobe/error.h"

namespace lobe {

using Kind = HandCommand::Kind;

template <class Real>
HapticHand<Real>::HapticHand(Session<Real>& session, HapticLink& link, const Settings& settings)
    : session_(session), link_(link), settings_(settings), stiffness_(settings.stiffness) {
  if (settings.controller < 0) made_controller_.emplace(session.connect("haptic"));
  controller_ = made_controller_ ? made_controller_->number() : settings.controller;
  session.between_frames([&] { session.add_hook(*this); });
}

template <class Real>
HapticHand<Real>::~HapticHand() {
  session_.between_frames([&] { session_.remove_hook(*this); });
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
  if (state.bad_poses > last_.bad_poses)
    hands.say("haptic_pose",
              "the haptic device has sent a pose that is not finite: it was left out, and the force fades");
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
// six times too stiff, would give a blow.
constexpr double first_share = 0.25;

// Of any kind of tool: what the body does to it in the mean of the last frame.
struct Felt {
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  bool only_pushes = false;  // it holds nothing
  double radius = 0;         // of its tip [m]
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
    felt.radius = tool.shape().radius;
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

template <class Real>
void HapticHand<Real>::feel(World<Real>& world, ToolId tool, double duration) {
  const Felt felt = felt_by(world, tool);
  model_.force = felt.force;
  model_.torque = felt.torque;
  model_.is_bilateral = !felt.only_pushes;
  std::vector<Index> contact;
  if (!felt.only_pushes) {
    contact = held_by(world, tool);
    if (contact.empty() && felt.force.norm() > least_push)
      contact = near_tip(world, model_.tool_at_end, 1.5 * felt.radius);
  } else if (felt.force.norm() > least_push) {
    model_.normal = felt.force.normalized();
    contact = near_tip(world, model_.tool_at_end, 1.5 * felt.radius);
  }
  const auto u = world.displacements();
  const auto displacement = [&](Index v) -> Vec3d { return u.col(v).template cast<double>(); };
  stiffness_.after_frame(world.body().model, contact, displacement, model_.position, model_.force, duration,
                         felt.only_pushes ? first_share : 1);
  model_.K = stiffness_.K();
  model_.rate = stiffness_.rate();
}

template <class Real>
void HapticHand<Real>::after_frame(Hands<Real>& hands, World<Real>& world, double duration) {
  const auto led_tool = hands.led_tool(controller_, settings_.hand);
  const bool is_same = led_tool.tool != 0 && led_tool.tool == tool_;
  if (!is_same) {
    stiffness_.forget();
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
    model_.position = 0.5 * (before_ + led_tool.pose.position);
    feel(world, led_tool.tool, duration);
  }
  if (LocalModel* shared = link_.model.writable()) {
    *shared = model_;
    link_.model.publish();
  }
}

template class HapticHand<float>;
template class HapticHand<double>;

}  // namespace lobe
