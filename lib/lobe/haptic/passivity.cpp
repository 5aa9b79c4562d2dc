#include "lobe/haptic/passivity.h"

#include <algorithm>
#include <cmath>

namespace lobe {

double passive_stiffness(double device_damping, double coupling_damping, double tick) {
  return 2 * std::max(0.0, device_damping - std::abs(coupling_damping)) / tick;
}

void Passivity::observe(const Vec3d& force, const Vec3d& way, double dt) {
  energy_ += device_damping_ * way.squaredNorm() / dt - force.dot(way);
}

void Passivity::forget_above(double stored) { energy_ = std::min(energy_, stored); }

double Passivity::damping(const Vec3d& velocity, double dt) const {
  const double square = velocity.squaredNorm();
  if (energy_ >= -deadband_ || square == 0) return 0;
  return std::min(highest_damping_, -energy_ / (dt * square));
}

}  // namespace lobe
