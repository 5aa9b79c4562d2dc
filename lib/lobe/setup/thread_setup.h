// Threads with which a body is sewn (forces/threads.h).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/embedded_point.h"
#include "lobe/setup/force_setup.h"
#include "lobe/setup/rigid_shape.h"

namespace lobe {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

struct ThreadMaterial {
  double stiffness = 98;        // EA [N]: its tension per strain; 98 is a braided 3-0 thread
  double friction = 0.2;        // μ of the capstan law, where it passes through tissue
  double strength = unlimited;  // tension above which it breaks [N]
  double holds = unlimited;     // force that tissue bears at a bite, before the thread cuts into it [N]
  bool operator==(const ThreadMaterial&) const = default;
  void check(const Expect& expect, const std::string& whose) const;
  static constexpr auto fields = std::tuple(&ThreadMaterial::stiffness, &ThreadMaterial::friction,
                                            &ThreadMaterial::strength, &ThreadMaterial::holds);
};

// A knot: the thread between two of its bites becomes a closed loop.
struct TieSetup {
  Index from = 0, to = 0;  // the bites, counted from 0 in the order in which they were sewn
  double at = 0;           // [s]
  double tighten = 0;      // length by which the loop is then drawn together [m]
  double over = 0.2;       // time that this takes [s]
  void check(const Expect& expect, const std::string& whose) const;
  void check(const Expect& expect, const std::string& whose, std::size_t bites) const;
  static constexpr auto fields =
      std::tuple(&TieSetup::from, &TieSetup::to, &TieSetup::at, &TieSetup::tighten, &TieSetup::over);
};

// A length of thread that is drawn through the tissue: one loop, or a running suture.
struct StitchSetup {
  std::string name;  // name in messages
  ThreadMaterial material;
  std::vector<EmbeddedPoint> bites;  // at least two, in the order in which the needle passes them
  double at = 0;                     // time at which it is sewn [s]
  std::vector<TieSetup> ties;
  void check(const Expect& expect) const;
  static constexpr const char* term = "threads";
  template <class Real>
  static NewTerm<Real> make_term(const Setup& setup);
  static void check_all(const std::vector<StitchSetup>& all, const Body& body, const Expect& expect);
  static constexpr auto fields =
      std::tuple(&StitchSetup::material, &StitchSetup::bites, &StitchSetup::at, &StitchSetup::ties);
};

}  // namespace lobe
