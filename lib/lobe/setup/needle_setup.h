// A needle that sews (tool/needle.h).
#pragma once

#include <optional>

#include "lobe/setup/needle_shape.h"
#include "lobe/setup/thread_setup.h"
#include "lobe/setup/tool_path.h"

namespace lobe {

// The thread at the end of a needle.
struct NeedleThread {
  int number = 0;
  ThreadMaterial material = {};     // if there is none of this number yet, as the rest
  double length = 0.45;             // [m]
  std::vector<TieSetup> ties = {};  // of bites that it has then
};
inline bool is_thread_length(double length) { return length > 0 && std::isfinite(length); }  // [m]

struct NeedleSetup {
  static constexpr const char* type = "needle";
  std::string name;
  NeedleSettings settings;
  std::optional<int> thread;    // number of the thread at its end; none: it has none
  ThreadMaterial material;      // of that thread, if there is none of this number yet
  double thread_length = 0.45;  // its length [m]
  std::vector<TieSetup> ties;   // knots of that thread, by the numbers of its bites
  std::vector<PathPoint> path;  // centres of its circle and orientations
  bool release = false;         // whether it is taken away after the last row; else it stays there
  bool needs_force_term() const { return true; }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    const std::string whose = type_and_name(*this), fault = settings.fault();
    expect(fault.empty(), whose + " " + fault);
    expect(!thread || *thread >= 0, whose + " has a thread of a number below 0");
    if (thread) material.check(expect, "the thread of " + whose);
    for (const TieSetup& tie : ties) tie.check(expect, "the thread of " + whose);
    expect(is_thread_length(thread_length), whose + " needs a thread of a length above 0 m, and finite");
  }
  static constexpr auto fields =
      std::tuple(&NeedleSetup::settings, &NeedleSetup::thread, &NeedleSetup::material,
                 &NeedleSetup::thread_length, &NeedleSetup::ties, &NeedleSetup::path, &NeedleSetup::release);
};

}  // namespace lobe
