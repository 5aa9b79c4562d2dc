// Devices that need no hardware, and the one that a vendor's own loop drives.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "lobe/haptic/link.h"
#include "lobe/live/pose_filter.h"

namespace lobe {

// Where a pointer is, for a device in another thread.
class PointerTarget {
 public:
  using At = std::optional<Vec3d>;  // [m]; none: it aims at nothing
  void aim(const At& target) {      // called by one thread
    if (At* at = points_.writable()) {
      *at = target;
      points_.publish();
    }
  }
  At read() const {  // called by one other thread
    const auto at = points_.latest();
    return at ? *at : At{};
  }

 private:
  TripleBuffer<At> points_;
};

// A mouse in the place of a device: it has no force, which is only shown. Its pointer comes some times a
// second; the device follows it smoothly, from where the pointer was first or where a tool is taken up.
class MouseDevice final : public HapticDevice {
 public:
  explicit MouseDevice(double tick = 1e-3) : tick_(tick) {}
  // Without a target the device stays where it is until it is aimed again: the next tool is somewhere else.
  void aim(const std::optional<Vec3d>& target) { target_.aim(target); }

  std::string name() const override { return "mouse"; }
  DeviceLimits limits() const override { return {.force = 20, .stiffness = 1000, .damping = 0.65}; }
  bool read(DeviceState& state) noexcept override;
  void begin_at(const Vec3d& tool) noexcept override;
  void write(const Vec3d&, const Vec3d&) noexcept override {}

 private:
  const double tick_;
  PointerTarget target_;
  bool is_there_ = false, begins_ = false;
  PoseFilter filter_;
};

// A hand with a device in it, simulated: a mass on a damper, which a spring draws along a path. Each read()
// is one tick.
class SimulatedHand final : public HapticDevice {
 public:
  struct Mechanics {
    double mass = 0.1;        // mass of device and fingers [kg]
    double damping = 0.5;     // damping of the device [N s/m]
    double grip = 300;        // stiffness of the hand [N/m]; 0: it lets go
    double grip_damping = 5;  // [N s/m]
  };
  using Path = std::function<Vec3d(double time)>;  // [s] → [m]

  // Follows a path of its own, or, without one, aim().
  SimulatedHand(const Mechanics& mechanics, Path path, double tick = 1e-3);
  void aim(const std::optional<Vec3d>& target) { target_.aim(target); }  // as a MouseDevice
  void unplug(bool unplugged) { is_plugged_ = !unplugged; }

  std::string name() const override { return "hand"; }
  DeviceLimits limits() const override {
    return {.force = 20, .stiffness = 1000, .damping = mechanics_.damping};
  }
  bool read(DeviceState& state) noexcept override;
  void begin_at(const Vec3d& tool) noexcept override;
  void write(const Vec3d& force, const Vec3d&) noexcept override { force_ = force; }

  double energy() const;  // kinetic, and of the hand's spring [J]

 private:
  void move(double dt);

  const Mechanics mechanics_;
  const Path path_;
  const double tick_;
  PointerTarget target_;
  std::atomic<bool> is_plugged_ = true;
  bool is_there_ = false;
  double time_ = 0;
  Vec3d goal_ = Vec3d::Zero(), position_ = Vec3d::Zero(), velocity_ = Vec3d::Zero(), force_ = Vec3d::Zero();
};

// A device for the servo loop of a vendor's library or of an engine. It calls force() at its own rate, about
// every millisecond, from one thread. Wait-free; it does not allocate or throw.
class ExternalDevice {
 public:
  ExternalDevice(HapticLink& link, const DeviceLimits& limits, const ServoOptions& options = {})
      : servo_(link, limits, options), tick_(options.tick) {}

  // `device`: null if there is none. Time goes by the clock, or by `dt` since the last call [s].
  const HapticState& force(const DeviceState* device);
  const HapticState& force(const DeviceState* device, double dt) { return servo_.tick(device, dt); }

 private:
  using Clock = std::chrono::steady_clock;
  LinkedServo servo_;
  const double tick_;
  bool is_running_ = false;
  Clock::time_point last_{};
};

}  // namespace lobe
