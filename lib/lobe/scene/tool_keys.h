// Keys of `tools` (docs/scene/tools.md), in addition to `name`, `type` and `path`. Internal, not part of the
// public interface.
#pragma once

#include "lobe/scene/boundary_keys.h"
#include "lobe/scene/contact_keys.h"

namespace lobe::keys {

template <>
inline constexpr std::array words_of<CutSurface>{"smooth", "faces"};

inline constexpr auto grasp_keys =
    Table("grasp", "",
          Key("where", &Tool::where, any.required().quiet(),
              "the vertices it takes hold of. It moves the components that `boundary` leaves free"),
          Key("hold_by", &Tool::hold_by, any.quiet(), hold_by_sentence),
          Key("copies", &Tool::copies,
              any.optional().as(
                  R"({"type": "array", "minItems": 1, "uniqueItems": true,
                                    "items": {"$ref": "#/definitions/index"}})",
                  "list of integers"),
              "further vertices, which cuts make before it takes hold; `where` may then select none"),
          Key("release", &Tool::release, any,
              "whether it lets go after the last row; otherwise it holds on there"));

inline constexpr auto cautery_keys = Table(
    "cautery", "",
    Key("radius", &Tool::radius, above(0).in("m").required(), "radius of its spherical tip, and of its hook"),
    Key("hook", &Tool::hook, any.in("m").with(&Takes::is_quiet, true),
        "vector from the tip to the end of a hook: a straight wire that burns all along. Zero: it has none"),
    Key("core", &Tool::core, at_least(0).in("m").quiet(),
        "radius of a rigid wire inside it, which tissue touches as it does a probe: the hook of a hand lifts "
        "and pushes. Below `radius`. 0: it has none"));

inline constexpr auto scalpel_keys =
    Table("scalpel", "",
          Key("surface", &Tool::surface, any,
              "`\"smooth\"`: the cut is the surface that the blade sweeps, through tetrahedra. `\"faces\"`: "
              "it follows faces of the mesh"),
          Key("blade", When(&Tool::blade, never), any.in("m").optional(),
              "vector from tip to heel, where it is the same all along: rows of the path are then [time, x, "
              "y, z] of the tip"),
          Key("snap", &Tool::snap, at_least(0.02).up_to(0.3),
              "a vertex nearer to the cut than this share of its shortest edge lies on the cut"));

inline constexpr auto probe_keys =
    Table("probe", "", Key("shape", &Tool::shape, any.required(), "what touches the organ"),
          Key("friction", &Tool::friction, at_least(0), "coefficient of Coulomb's law against tissue"),
          Key("release", &Tool::release, any,
              "whether it is taken away after the last row; otherwise it stays there"));

inline constexpr auto clip_applier_keys =
    Table("clip_applier", "",
          Key("length", In{&Tool::clip, &ClipShape::length}, above(0).in("m").required(),
              "length of the legs of a clip, along its x axis"),
          Key("opening", In{&Tool::clip, &ClipShape::opening}, above(0).in("m").required(),
              "distance of the legs before the clip closes, along its z axis"),
          Key("gap", In{&Tool::clip, &ClipShape::gap}, above(0).in("m").required(),
              "distance of the legs when the clip has closed; below `opening`"),
          Key("width", In{&Tool::clip, &ClipShape::width}, above(0).in("m"),
              "width of the legs along the y axis, which is that of the duct"),
          Key("stiffness", In{&Tool::clip, &ClipShape::stiffness}, above(0).in("N/m"),
              "force by which closed legs resist being further apart"));

}  // namespace lobe::keys
