// Attachments of a scene, and their keys (docs/scene/boundary.md).
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "lobe/scene/key_rows.h"
#include "lobe/scene/selector.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct Resolution;

// A bed of strands between two parts of the surface, or a ligament between two points.
struct SceneBed {
  Selector from;                               // boundary faces
  std::optional<Selector> to;                  // boundary faces; none: the world
  double within = 0;                           // greatest length of strands [m]; 0: only where faces touch
  double spacing = 0;                          // distance of strands, roughly [m]; 0: one per face
  double stiffness = 0;                        // stiffness per area [Pa/m]
  std::optional<double> fracture_energy = {};  // [J/m²]; none: it never tears
};
struct SceneLigament {
  Vec3d from, to;                       // [m]
  bool ends_in_world = false;           // the second point does not move
  double stiffness = 0;                 // [N/m]
  double slack = 0;                     // excess of its length over the way between its ends [m]
  std::optional<double> strength = {};  // largest tension [N]; none: it never tears
};
struct SceneAttachment {
  std::string name;
  double softening = 3;  // elongation at which it has torn over that at which it begins to
  std::variant<SceneBed, SceneLigament> what;
  std::string pointer;

  static constexpr const char* key = "attachments";
  static constexpr const char* sentence =
      "tissue that ties organs to each other or to the world, and tears: beds and ligaments";
  static void resolve(const std::vector<SceneAttachment>& all, Resolution& resolution);
  template <class Json>
  Json summary(const Setup& setup, std::size_t number) const;
  template <class Json>
  static void print(const Json& summary, std::ostream& out);
  static void for_each_selector(auto& attachment, const auto& visit) {
    if (auto* bed = std::get_if<SceneBed>(&attachment.what)) {
      visit(bed->from, Selects::faces, "/bed/from");
      if (bed->to) visit(*bed->to, Selects::faces, "/bed/to");
    }
  }
  void for_each_point(const auto& visit) {
    if (auto* ligament = std::get_if<SceneLigament>(&what)) {
      visit(ligament->from);
      if (!ligament->ends_in_world) visit(ligament->to);
    }
  }
};

namespace keys {

// How a bed ends: on another part of the surface, with strands up to a length, or in the world.
struct BedEndsInWorld {
  True& operator()(SceneBed&) const { return is_true; }
  const True* operator()(const SceneBed& bed) const { return bed.to ? nullptr : &is_true; }
};
template <>
inline constexpr auto table_of<SceneBed> = Table(
    "bed", R"({"description": "Strands that cover a part of the surface.",
        "dependencies": {"to": ["within"], "within": ["to"]},
        "oneOf": [{"required": ["to"]}, {"required": ["to_world"]}]})",

    Key("from", &SceneBed::from, any.required(), "boundary faces on which strands begin"),
    Key("to", &SceneBed::to, any.optional(), "boundary faces to which they lead, each to the nearest point"),
    Key("to_world", BedEndsInWorld{}, any.optional(),
        "in place of `to`: strands hold their beginnings where these are at rest"),
    Key("within", When(&SceneBed::within, [](const SceneBed& bed) { return bed.to.has_value(); }),
        at_least(0).in("m").optional(),
        "longest strand, with `to`. Where the other part is further away there is none"),
    Key("spacing", &SceneBed::spacing, above(0).in("m").optional(),
        "about how far strands are apart: faces are divided evenly. Without it each face has one strand"),
    Key("stiffness", &SceneBed::stiffness, above(0).in("Pa/m").required(), "force per area and elongation"),
    Key("fracture_energy", &SceneBed::fracture_energy, above(0).in("J/m²").optional(),
        "energy per area that tears it; without it the bed does not tear"));

template <>
inline constexpr auto table_of<SceneLigament> =
    Table("ligament",
          R"({"description": "One strand.", "oneOf": [{"required": ["to"]}, {"required": ["to_world"]}]})",

          Key("from", &SceneLigament::from, any.in("m").required(), "a point of the body at rest"),
          Key("to", Case(&SceneLigament::ends_in_world, false, &SceneLigament::to), any.in("m").optional(),
              "another point of the body at rest"),
          Key("to_world", Case(&SceneLigament::ends_in_world, true, &SceneLigament::to),
              any.in("m").optional(), "in place of `to`: a point that does not move"),
          Key("stiffness", &SceneLigament::stiffness, above(0).in("N/m").required(), "force per elongation"),
          Key("slack", &SceneLigament::slack, at_least(0).in("m"),
              "length by which it is longer than the way between its ends"),
          Key("strength", &SceneLigament::strength, above(0).in("N").optional(),
              "its largest force; without it the ligament does not tear"));

template <>
inline constexpr auto table_of<SceneAttachment> =
    Table("attachment", R"({"oneOf": [{"required": ["bed"]}, {"required": ["ligament"]}]})",

          Key("name", &SceneAttachment::name, any.items(1).required(),
              "different from those of the other attachments"),
          Key("softening", &SceneAttachment::softening, above(1).up_to(1000),
              "elongation at which a strand has torn, over that at which its force begins to fall"),
          Key("bed", alternative<SceneBed>(&SceneAttachment::what), any.optional(),
              "strands that cover a part of the surface"),
          Key("ligament", alternative<SceneLigament>(&SceneAttachment::what), any.optional(), "one strand"));

}  // namespace keys
}  // namespace lobe
