// Keys of `boundary`, `threads` and `attachments` (docs/scene/boundary.md). Internal, not part of the public
// interface.
#pragma once

#include "lobe/scene/key_table.h"

namespace lobe {

// Components of a displacement that are null are free.
inline void after_reading(const nlohmann::json& object, Boundary& boundary) {
  if (boundary.kind != Boundary::Kind::displacement) return;
  for (std::size_t i = 0; i < 3; ++i) boundary.axes[i] = !object["displacement"][i].is_null();
}
inline void after_writing(const Boundary& boundary, nlohmann::ordered_json& object) {
  if (boundary.kind != Boundary::Kind::displacement) return;
  for (std::size_t i = 0; i < 3; ++i)
    if (!boundary.axes[i]) object["displacement"][i] = nullptr;
}

}  // namespace lobe

namespace lobe::keys {

// ---- What holds and loads

template <>
inline constexpr auto words_of<HoldBy> = hold_by_names;
inline constexpr const char* hold_by_sentence =
    "what is held: the selected vertices wholly, or each vertex by the share of its volume, or of its area "
    "of the surface, that lies in the selection. A share below 0.95 is held by a spring. The latter two hold "
    "the same body on every mesh";

template <>
inline constexpr auto table_of<Boundary> = Table(
    "boundary",
    R"({"oneOf": [{"required": ["fix"]}, {"required": ["displacement"]}, {"required": ["traction"]},
                              {"required": ["force"]}, {"required": ["pressure"]}]})",

    Key("fix", Says(&Boundary::kind, Boundary::Kind::fix), any.optional(),
        "holds the vertices at their rest positions"),
    Key("displacement", Case(&Boundary::kind, Boundary::Kind::displacement, &Boundary::value),
        any.in("m").optional().as(
            R"({"type": "array", "minItems": 3, "maxItems": 3, "items": {"type": ["number", "null"]}})",
            "[x, y, z]"),
        "moves the vertices by this much over `time.ramp`, and then holds them; they slide freely along "
        "components that are `null`"),
    Key("traction", Case(&Boundary::kind, Boundary::Kind::traction, &Boundary::value),
        any.in("Pa").optional(), "dead load per rest area"),
    Key("force", Case(&Boundary::kind, Boundary::Kind::force, &Boundary::value), any.in("N").optional(),
        "total dead load, shared equally among the selected vertices"),
    Key("pressure", Case(&Boundary::kind, Boundary::Kind::pressure, &Boundary::pressure),
        any.in("Pa").optional(),
        "pressure per present area along the present normal: it turns and grows with the wall; "
        "positive pushes into the body"),
    Key("hold_by", &Boundary::hold_by, any.quiet(), hold_by_sentence),
    Key("where", &Boundary::where, any.required(), "what is held, or loaded"));

// ---- Threads

template <>
inline constexpr auto table_of<SceneTie> = Table(
    "tie", "",

    Key("at", &SceneTie::at, at_least(0).in("s").required(), "when it is tied"),
    Key("tighten", &SceneTie::tighten, at_least(0).in("m"), "length by which the loop is drawn together"),
    Key("over", &SceneTie::over, at_least(0).in("s"), "time in which it is drawn together"),
    Key("between", &SceneTie::between, any.optional(),
        "two points of the stitch, numbered from 0, that the knot joins; without it, the first and the "
        "last"));

template <>
inline constexpr auto table_of<SceneStitch> =
    Table("stitch", "",
          Key("through", &SceneStitch::through, any.in("m").items(2).required(),
              "two points of the body at rest or more, through which the thread passes in this order"),
          Key("at", &SceneStitch::at, at_least(0).in("s"),
              "when it is sewn: at the start of the first frame that begins then"),
          Key("tie", &SceneStitch::ties, any.or_one(), "a knot, or several"));

template <>
inline constexpr auto table_of<SceneThread> =
    Table("thread", "", Key("name", &SceneThread::name, any, "for reports"),
          Key("stiffness", In{&SceneThread::material, &ThreadMaterial::stiffness}, above(0).in("N"),
              "EA: tension per strain"),
          Key("friction", In{&SceneThread::material, &ThreadMaterial::friction}, at_least(0),
              "μ of the capstan law T₂ = T₁ e^(μθ), where the thread passes through tissue"),
          Key("strength", In{&SceneThread::material, &ThreadMaterial::strength}, above(0).in("N").optional(),
              "tension above which the thread breaks; without it, it does not"),
          Key("holds", In{&SceneThread::material, &ThreadMaterial::holds}, above(0).in("N").optional(),
              "force that tissue bears at a bite; without it, any. Above it the thread cuts into the tissue; "
              "at the surface it tears out"),
          Key("stitches", &SceneThread::stitches, any.items(1).required(), "lengths of this thread"));

// ---- Attachments

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

}  // namespace lobe::keys
