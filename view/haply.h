// Devices of Haply, through their Inverse Service, which runs on the same machine and has a WebSocket with
// JSON messages both ways. Each state of a device is answered with a force.
//
//   ← {"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x": …, "y": …, "z": …},
//                                                   "cursor_velocity": {…}}}],
//      "wireless_verse_grip": [{"state": {"orientation": {"w": …, "x": …, "y": …, "z": …},
//                                         "buttons": {"a": true, "b": false, "c": false}}}]}
//   → {"inverse3": [{"device_id": "049D", "commands": {"set_cursor_force": {"values": {"x": …, …}}}}]}
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "lobe/haptic/device.h"
#include "lobe/snapshot/triple_buffer.h"

namespace lobe::view {

// Reads a message. False if it says nothing of a device.
struct HaplyMessage {
  std::string device;  // its id
  DeviceState state;
};
bool read_haply(std::string_view text, HaplyMessage& message);
std::string haply_force(const std::string& device, const Vec3d& force);

class HaplyDevice final : public HapticDevice {
 public:
  // Connects in a thread of its own, and again whenever the connection is lost.
  explicit HaplyDevice(const std::string& host = "localhost", int port = 10001);
  ~HaplyDevice() override;

  std::string name() const override { return "haply"; }
  DeviceLimits limits() const override { return {.force = 2, .stiffness = 1000, .damping = 0.5}; }
  bool read(DeviceState& state) noexcept override;
  void write(const Vec3d& force, const Vec3d& torque) noexcept override;

 private:
  struct Client;
  struct Stamped {
    std::uint64_t number = 0;  // number of the message
    DeviceState state;
  };

  TripleBuffer<Stamped> states_;
  TripleBuffer<Vec3d> forces_;
  Stamped last_;
  int ticks_without_ = 1 << 20;  // ticks since a message came
  std::unique_ptr<Client> client_;
  std::thread thread_;
};

}  // namespace lobe::view
