// A needle that sews (tool/needle.h).
#pragma once

#include <optional>

#include "lobe/setup/needle_shape.h"
#include "lobe/setup/thread_setup.h"
#include "lobe/setup/tool_path.h"

namespace lobe {

struct NeedleSetup {
  static constexpr const char* type = "needle";
  std::string name;
  NeedleSettings settings;
  std::optional<int> thread;    // number of the thread at its end; none: it has none
  ThreadMaterial material;      // of that thread, if there is none of this number yet
  std::vector<PathPoint> path;  // centres of its circle and orientations
  bool release = false;         // whether it is taken away after the last row; else it stays there
  bool needs_force_term() const { return true; }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    const std::string whose = type_and_name(*this), fault = settings.fault();
    expect(fault.empty(), whose + " " + fault);
    expect(!thread || *thread >= 0, whose + " has a thread of a number below 0");
    if (thread) material.check(expect, "the thread of " + whose);
  }
  static constexpr auto fields =
      std::tuple(&NeedleSetup::settings, &NeedleSetup::thread, &NeedleSetup::material, &NeedleSetup::path,
                 &NeedleSetup::release);
};

}  // namespace lobe
