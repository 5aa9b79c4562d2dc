#include "lobe/setup/contact_setup.h"

#include <cmath>

namespace lobe {

void ObstacleSetup::check(const Expect& expect) const {
  const std::string whose = "obstacle \"" + name + "\"";
  shape.check(expect, whose);
  expect(position.allFinite() && std::abs(orientation.norm() - 1) < 1e-6,
         whose + " needs a finite position and a unit quaternion for its orientation");
  expect(std::isfinite(friction) && friction >= 0, whose + " needs a friction of at least 0, and finite");
}

void ContactSetup::check(const Expect& expect) const {
  expect(std::isfinite(friction) && friction >= 0, "contact needs a friction of at least 0, and finite");
  expect(std::isfinite(damping) && damping >= 0 && damping <= 0.2, "contact: damping must be in [0, 0.2]");
  for (const ObstacleSetup& obstacle : obstacles) obstacle.check(expect);
}

}  // namespace lobe
