// A haptic device: where a hand is comes in, forces go out.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "lobe/types.h"

namespace lobe {

struct DeviceState {
  Vec3d position = Vec3d::Zero();           // [m]
  Vec3d velocity = Vec3d::Zero();           // [m/s]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  std::uint32_t buttons = 0;                // one bit each

  bool is_finite() const { return position.allFinite() && velocity.allFinite() && orientation.allFinite(); }
};

// The limits of a device and its own damping.
struct DeviceLimits {
  double force = 3;         // greatest force that it is asked for [N]
  double torque = 0.1;      // [N m]
  double slew = 200;        // the fastest change of the force [N/s]
  double stiffness = 1000;  // stiffness of the stiffest coupling [N/m]
  double damping = 0.5;     // damping b that its mechanics and the hand have in any case [N s/m]
};

// Throws InputError for limits that are not positive and finite.
void check(const DeviceLimits& limits, const std::string& device);

// One thread, that of the loop, calls all of it, once per tick. read() and write() neither wait, lock,
// allocate nor throw.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual std::string name() const = 0;
  virtual DeviceLimits limits() const = 0;
  virtual bool read(DeviceState& state) noexcept = 0;  // false: the device is not there
  // A tool has been taken up. It is here, in the coordinates of the tool [m]. A device without a place of its
  // own is there from now on. Others stay where they are, and drive the tool from there.
  virtual void begin_at(const Vec3d&) noexcept {}
  // Puts force and torque on the hand [N], [N m].
  virtual void write(const Vec3d& force, const Vec3d& torque) noexcept = 0;
};

}  // namespace lobe
