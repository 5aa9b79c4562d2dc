// Keys of `boundary` (docs/scene/boundary.md). Internal, not part of the public interface.
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

}  // namespace lobe::keys
