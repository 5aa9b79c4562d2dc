// A cautery: it burns what its tip or its hook touches (tool/cautery.h).
#pragma once

#include <cmath>

#include "lobe/setup/tool_path.h"

namespace lobe {

struct CauterySetup {
  static constexpr const char* type = "cautery";
  std::string name;
  double radius = 0;            // [m]
  std::vector<PathPoint> path;  // positions of the tip, and turns of the hook
  // Vector from its tip to the end of a hook, which burns all along [m], before it turns; zero: it has none.
  Vec3d hook = Vec3d::Zero();
  double core = 0;  // radius of a rigid wire in it, which tissue feels [m]; 0: tissue feels nothing
  bool needs_force_term() const { return core > 0; }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    expect(std::isfinite(radius) && radius > 0, type_and_name(*this) + " needs a radius above 0");
    expect(hook.allFinite(), type_and_name(*this) + " needs a finite hook");
    expect(core >= 0 && core < radius,
           type_and_name(*this) + " needs a core of at least 0 m that is thinner than it");
  }
  static constexpr auto fields =
      std::tuple(&CauterySetup::radius, &CauterySetup::path, &CauterySetup::hook, &CauterySetup::core);
};

}  // namespace lobe
