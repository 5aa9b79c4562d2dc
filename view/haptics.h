// The haptic hand of a live session, and the device that it leads.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "lobe/haptic/devices.h"
#include "lobe/haptic/haptic_hand.h"
#include "lobe/haptic/loop.h"

namespace lobe::view {

inline constexpr const char* haptic_devices[] = {"none", "mouse", "hand", "haply"};

struct HapticOptions {
  std::string device = "none";
  std::string haply_host = "localhost";
  int haply_port = 10001;
  bool is_direct = false;  // frames of 1 ms; only told
};

// A device with the loop that drives it, from when it is made until it is destroyed. There is one in the
// program. It belongs to the session whose hand it leads (Haptics), and is moved from one to the next.
class HapticRig {
 public:
  // `options.device` is one of haptic_devices, but none.
  explicit HapticRig(const HapticOptions& options);

  HapticLink& link() { return link_; }
  // Whether it takes hold by its own button, rather than when a page does.
  bool has_buttons() const { return haply_ != nullptr; }
  // Where the pointer of a page is; none: it aims at nothing.
  void aim(const std::optional<Vec3d>& target);
  nlohmann::json figures() const;

 private:
  const HapticOptions options_;
  HapticLink link_;
  std::unique_ptr<MouseDevice> mouse_;
  std::unique_ptr<SimulatedHand> simulated_;
  std::unique_ptr<HapticDevice> haply_;
  std::unique_ptr<HapticLoop> loop_;
};

template <class Real>
class Haptics {
 public:
  Haptics(Session<Real>& session, std::unique_ptr<HapticRig> rig);

  // Call it when the page gets another controller, or none. Its tool is let go by the session.
  void change_hands(std::optional<int> controller);
  // Takes a command of the page. True if it concerns the device and not the session.
  bool takes(const HandCommand& command);
  const HapticRig& rig() const { return *rig_; }
  // Ends the hand in this session: the device is without force until another session has it.
  std::unique_ptr<HapticRig> release();

 private:
  static constexpr HandNumber hand_of_page = 0;

  Session<Real>& session_;
  std::unique_ptr<HapticRig> rig_;
  std::unique_ptr<HapticHand<Real>> hand_;
};

extern template class Haptics<float>;
extern template class Haptics<double>;

}  // namespace lobe::view
