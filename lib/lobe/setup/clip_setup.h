// Clips, and bodies that carry what bleeds or leaks where they are cut (forces/clips.h).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/embedded_point.h"
#include "lobe/setup/force_setup.h"

namespace lobe {

// A clip of two legs. Its axes: x along the legs, y along the duct, z from leg to leg; its centre is their
// middle.
struct ClipShape {
  double length = 0;        // length of the legs [m]
  double opening = 0;       // distance of the legs before they close [m]
  double gap = 0;           // distance of the legs once closed [m]; below the opening
  double width = 1e-3;      // width of each leg along y [m]
  double stiffness = 1000;  // force by which the closed legs resist being further apart [N/m]
  bool operator==(const ClipShape&) const = default;
  std::string fault() const;  // empty: there is none
  static constexpr auto fields = std::tuple(&ClipShape::length, &ClipShape::opening, &ClipShape::gap,
                                            &ClipShape::width, &ClipShape::stiffness);
};

// A clip that has been closed.
struct ClipSetup {
  struct Pair {  // points of the surface that face each other between the legs
    EmbeddedPoint from, to;
    double apart = 0;  // distance at the begin of closing [m]
    bool operator==(const Pair&) const = default;
    static constexpr auto fields = std::tuple(&Pair::from, &Pair::to, &Pair::apart);
  };
  std::string name;
  ClipShape shape;
  int tool = 0, number = 0;     // number of the applier, and of the clip among those that it has closed
  double since = 0;             // time at which it began to close [s]
  std::vector<Pair> pairs;      // pairs that are left
  std::vector<Index> squeezed;  // tetrahedra that its middle plane crosses: nothing flows through them
  bool operator==(const ClipSetup&) const = default;
  void check(const Expect& expect) const;
  static constexpr const char* term = "clips";
  template <class Real>
  static NewTerm<Real> make_term(const Setup& setup);
  static void check_all(const std::vector<ClipSetup>& all, const Body& body, const Expect& expect);
  static constexpr auto fields =
      std::tuple(&ClipSetup::shape, &ClipSetup::tool, &ClipSetup::number, &ClipSetup::since,
                 &ClipSetup::pairs, &ClipSetup::squeezed, &ClipSetup::name);
};

enum class Carries : std::uint8_t { nothing, blood, bile };
inline constexpr std::array<const char*, 3> carries_names{"nothing", "blood", "bile"};

// A body of which all of the inside is open to what flows in it: a duct, a vessel.
struct CarrierSetup {
  int body = 0;  // number of the body (MeshBodies)
  Carries carries = Carries::blood;
  std::vector<Index> fed;  // vertices at which the flow comes in
  bool operator==(const CarrierSetup&) const = default;
  static constexpr auto fields = std::tuple(&CarrierSetup::body, &CarrierSetup::carries, &CarrierSetup::fed);
};

}  // namespace lobe
