// A clip applier: it closes a clip at each row of its path, on what lies between its jaws
// (tool/clip_applier.h).
#pragma once

#include "lobe/setup/clip_setup.h"
#include "lobe/setup/tool_path.h"

namespace lobe {

struct ClipApplierSetup {
  static constexpr const char* type = "clip_applier";
  std::string name;
  ClipShape clip;
  std::vector<PathPoint> path;  // times, places and turns of the clips that close
  bool needs_force_term() const { return true; }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    const std::string fault = clip.fault();
    expect(fault.empty(), type_and_name(*this) + " " + fault);
  }
  static constexpr auto fields = std::tuple(&ClipApplierSetup::clip, &ClipApplierSetup::path);
};

}  // namespace lobe
