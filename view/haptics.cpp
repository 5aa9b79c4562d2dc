#include "haptics.h"

#include <nlohmann/json.hpp>

#include "haply.h"
#include "lobe/error.h"

namespace lobe::view {

using Json = nlohmann::json;
using Kind = HandCommand::Kind;

// ---- The device

HapticRig::HapticRig(const HapticOptions& options) : options_(options) {
  HapticDevice* device = nullptr;
  if (options.device == "mouse") device = (mouse_ = std::make_unique<MouseDevice>()).get();
  if (options.device == "hand")
    device = (simulated_ = std::make_unique<SimulatedHand>(SimulatedHand::Mechanics{}, nullptr)).get();
  if (options.device == "haply")
    device = (haply_ = std::make_unique<HaplyDevice>(options.haply_host, options.haply_port)).get();
  if (!device) throw InputError("--haptic", options.device + ": must be none, mouse, hand or haply");
  loop_ = std::make_unique<HapticLoop>(*device, link_);
  loop_->start();
}

void HapticRig::aim(const std::optional<Vec3d>& target) {
  if (mouse_) mouse_->aim(target);
  if (simulated_) simulated_->aim(target);
}

Json HapticRig::figures() const {
  Json json{{"device", options_.device}, {"direct", options_.is_direct}};
  const auto state = link_.state.latest();
  if (!state) return json;
  json["there"] = state->is_there;
  json["force"] = {state->force.x(), state->force.y(), state->force.z()};
  json["energy"] = state->energy;
  json["interventions"] = state->interventions;
  json["stale"] = state->stale;
  json["ticks"] = state->ticks;
  json["missed"] = loop_->times().missed.load();
  json["late"] = 1e-6 * loop_->times().lateness.quantile(0.99);
  json["real_time"] = loop_->is_real_time();
  json["warnings"] = loop_->warnings();
  return json;
}

// ---- Its hand in a session

template <class Real>
Haptics<Real>::Haptics(Session<Real>& session, std::unique_ptr<HapticRig> rig)
    : session_(session), rig_(std::move(rig)) {
  if (rig_->has_buttons()) hand_ = std::make_unique<HapticHand<Real>>(session, rig_->link());
}

template <class Real>
void Haptics<Real>::change_hands(std::optional<int> controller) {
  if (rig_->has_buttons()) return;
  hand_.reset();
  rig_->aim(std::nullopt);
  if (controller)
    hand_ = std::make_unique<HapticHand<Real>>(
        session_, rig_->link(),
        typename HapticHand<Real>::Settings{.controller = *controller, .hand = hand_of_page});
}

// Poses of the page's first hand go to the device, which the tool follows. The next tool is somewhere else.
// Until the page leads it, the device stays where that tool is (HapticDevice::begin_at()).
template <class Real>
bool Haptics<Real>::takes(const HandCommand& command) {
  if (rig_->has_buttons() || command.hand != hand_of_page) return false;
  if (command.kind == Kind::take_at_ray || command.kind == Kind::take_at_point || command.kind == Kind::bring)
    rig_->aim(std::nullopt);
  if (command.kind != Kind::lead) return false;
  rig_->aim(command.position);
  return true;
}

template <class Real>
std::unique_ptr<HapticRig> Haptics<Real>::release() {
  hand_.reset();
  rig_->aim(std::nullopt);
  return std::move(rig_);
}

template class Haptics<float>;
template class Haptics<double>;

}  // namespace lobe::view
