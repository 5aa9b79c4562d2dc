// The hand of a haptic device in a session. Once per frame it moves its tool to where the loop puts it, and
// tells the loop what the tool feels.
//
//   HapticLink link;
//   HapticHand<float> hand(session, link);                // leads hand 1 of its own controller
//   HapticLoop loop(device, link);
//   loop.start();
//
// Button 0 of the device takes hold of what is within reach, and lets go; or the hand takes over a tool that
// somebody else has brought (Settings::controller).
#pragma once

#include <optional>
#include <vector>

#include "lobe/haptic/contact_stiffness.h"
#include "lobe/haptic/link.h"
#include "lobe/live/session.h"

namespace lobe {

template <class Real>
class HapticHand final : public SessionHook<Real> {
 public:
  struct Settings {
    int controller = -1;  // controller whose hand it is; −1: one of its own, and the buttons take hold
    HandNumber hand = 1;
    double radius = 0.01;  // radius of what is taken hold of [m]
    ContactStiffness::Settings stiffness = {};
  };

  // Make it between frames of the session, which outlives it. The link has one hand at a time.
  HapticHand(Session<Real>& session, HapticLink& link, const Settings& settings = {});
  ~HapticHand() override;  // the loop then has no tool, and its force is none

  void before_frame(Hands<Real>& hands, World<Real>& world, double duration) override;
  void after_frame(Hands<Real>& hands, World<Real>& world, double duration) override;

 private:
  void publish(const LocalModel& model);
  void press_buttons(Hands<Real>& hands, const HapticState& state);
  void tell_troubles(Hands<Real>& hands, const HapticState& state);
  void feel(World<Real>& world, ToolId tool, const ToolPose& pose, double duration);
  void look_ahead(World<Real>& world, const RigidShape& shape, double opening, const ToolPose& pose);
  void place_first_touch(const Vec3d& at_end);
  double depth_to_come(const Vec3d& at_end) const;

  Session<Real>& session_;
  HapticLink& link_;
  const Settings settings_;
  std::optional<Controller> made_controller_;
  int controller_;
  ContactStiffness stiffness_;
  LocalModel model_;
  ToolId tool_ = 0;
  std::uint32_t engagement_ = 0;
  Vec3d before_ = Vec3d::Zero();  // place of the tool at the start of the frame [m]
  std::optional<Vec3d> touch_;    // place where a tool that feels nothing will begin to touch [m]
  bool is_pressed_ = false;
  HapticState last_;      // state of the last warning
  bool was_bad_ = false;  // whether its poses were bad
};

extern template class HapticHand<float>;
extern template class HapticHand<double>;

}  // namespace lobe
