// What ties bodies to each other or to the world, and gives way: beds, ligaments, connective tissue
// (forces/attachments.h).
#pragma once

#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/embedded_point.h"
#include "lobe/setup/force_setup.h"

namespace lobe {

// A straight elastic strand between two points. It pulls, and never pushes.
struct StrandSetup {
  EmbeddedPoint from;
  EmbeddedPoint to;              // no tetrahedron: it ends in the world, at the anchor
  Vec3d anchor = Vec3d::Zero();  // [m]
  double length = 0;             // natural length [m]
  double stiffness = 0;          // [N/m]
  double area = 0;               // area of the bed that it stands for [m²]; 0: it is of no bed
  double reached = 0;            // largest elongation so far [m]
  bool operator==(const StrandSetup&) const = default;
  bool ends_in_world() const { return to.tet < 0; }
  bool is_valid() const {
    return from.is_valid() && (ends_in_world() || to.is_valid()) && anchor.allFinite() &&
           std::isfinite(length) && length >= 0 && std::isfinite(stiffness) && stiffness > 0 &&
           std::isfinite(area) && area >= 0 && std::isfinite(reached) && reached >= 0;
  }
  static constexpr auto fields =
      std::tuple(&StrandSetup::from, &StrandSetup::to, &StrandSetup::anchor, &StrandSetup::length,
                 &StrandSetup::stiffness, &StrandSetup::area, &StrandSetup::reached);
};

struct AttachmentSetup {
  std::string name;  // name, different from the others'
  // Elongation δ_f from which its strands give way [m]; infinite: they never do.
  double holds_until = std::numeric_limits<double>::infinity();
  double softening = 3;  // c: a strand has torn at the elongation c δ_f; above 1
  std::vector<StrandSetup> strands;
  bool operator==(const AttachmentSetup&) const = default;
  void check(const Expect& expect) const;
  static constexpr const char* term = "attachments";
  template <class Real>
  static NewTerm<Real> make_term(const Setup& setup);
  static void check_all(const std::vector<AttachmentSetup>& all, const Body& body, const Expect& expect);
  static constexpr auto fields = std::tuple(&AttachmentSetup::name, &AttachmentSetup::holds_until,
                                            &AttachmentSetup::softening, &AttachmentSetup::strands);
};

}  // namespace lobe
