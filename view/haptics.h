// The haptic hand of a live session: its device, its loop, and what the page shows of them.
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

template <class Real>
class Haptics {
 public:
  // `options.device` is one of haptic_devices, but none.
  Haptics(Session<Real>& session, const HapticOptions& options);

  // Call it between frames when the page gets another controller, or none.
  void change_hands(std::optional<int> controller);
  // Takes a command of the page. True if it concerns the device and not the session.
  bool takes(const HandCommand& command);
  nlohmann::json figures() const;

 private:
  static constexpr HandNumber hand_of_page = 0;

  Session<Real>& session_;
  const HapticOptions options_;
  HapticLink link_;
  std::unique_ptr<MouseDevice> mouse_;
  std::unique_ptr<SimulatedHand> simulated_;
  std::unique_ptr<HapticDevice> other_;
  std::unique_ptr<HapticHand<Real>> hand_;
  std::unique_ptr<HapticLoop> loop_;
};

extern template class Haptics<float>;
extern template class Haptics<double>;

}  // namespace lobe::view
