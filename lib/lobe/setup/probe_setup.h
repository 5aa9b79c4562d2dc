// A probe: a rigid body, or jaws, that touch the organ (tool/probe.h).
#pragma once

#include <cmath>

#include "lobe/setup/tool_path.h"

namespace lobe {

inline constexpr double default_friction = 0.1;  // friction of a wet instrument against tissue [-]

struct ProbeSetup {
  static constexpr const char* type = "probe";
  std::string name;
  RigidShape shape;
  double friction = default_friction;  // Coulomb's coefficient against tissue
  std::vector<PathPoint> path;         // positions and orientations
  bool release = false;                // whether it is taken away after the last row; else it stays there
  bool needs_force_term() const { return true; }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    shape.check(expect, type_and_name(*this));
    expect(std::isfinite(friction) && friction >= 0,
           type_and_name(*this) + " needs a friction of at least 0, and finite");
  }
  static constexpr auto fields =
      std::tuple(&ProbeSetup::shape, &ProbeSetup::friction, &ProbeSetup::path, &ProbeSetup::release);
};

}  // namespace lobe
