// Keys of `bodies`, `regions` and what is in `auto` (docs/scene/regions.md). Internal, not part of the public
// interface.
#pragma once

#include "lobe/scene/key_table.h"

namespace lobe {

// Names a region, and below a gesture, that the scene does not name.
inline void after_reading(const nlohmann::json& object, Region& region) {
  if (!object.contains("name")) region.name = name(region.model);
}
inline void after_reading(const nlohmann::json& object, SceneGesture& gesture) {
  if (!object.contains("name")) gesture.name = gesture.pointer;
}

}  // namespace lobe

namespace lobe::keys {

template <>
inline constexpr auto words_of<Carries> = carries_names;
template <>
inline constexpr auto words_of<RegionModel> = region_model_names;
template <>
inline constexpr auto words_of<RegionFrame> = std::array{"fixed", "corotated"};

template <>
inline constexpr auto table_of<SceneBody> = Table(
    "body", "",

    Key("name", &SceneBody::name, any.items(1).required(),
        "for the selector `body`, reports and pictures; each body has another one"),
    Key("mesh", &SceneBody::mesh, any.items(1).required(), "file of its mesh, relative to the scene file"),
    Key("mesh_scale", &SceneBody::mesh_scale, above(0), "what the coordinates of its mesh are multiplied by"),
    Key("position", &SceneBody::position, any.in("m"),
        "where the origin of its coordinates is put, after scaling and turning"),
    Key("orientation", &SceneBody::orientation, any,
        "unit quaternion by which its mesh, and fibres in it, are turned about the origin of its "
        "coordinates"),
    Key("carries", &SceneBody::carries, any.quiet(),
        "what flows in all of its inside. It comes in where boundary holds the body. A cut that it reaches "
        "is the event `bleeding` or `leak`"));

template <>
inline constexpr auto table_of<Region> = Table(
    "region", R"({"removed": {"representation":
  "say \"precomputed\" or \"tensor-mass\" as the model, or let lobe choose: \"regions\": {\"auto\": {}}"}})",

    Key("name", &Region::name, any.derived(), "for reports; without it, the model"),
    Key("model", &Region::model, any.required(),
        "tensor-mass: linear and dynamic; precomputed: linear and always in equilibrium, condensed to its "
        "interface; nonlinear: the material's law, dynamic; reduced: the same on a lattice where motion is "
        "smooth; corotational: linear in the frame of each tetrahedron's rotation, and dynamic"),
    Key("frame", &Region::frame, any.quiet(),
        "frame of precomputed regions, the same for all. A corotated region follows the rigid motion that "
        "fits its interface best. It may turn as a whole and need not be held"),
    Key("cell", &Region::cell, above(0).in("m").optional(),
        "edge of the cells of the lattice of reduced regions, the same for all. Without it: a twentieth of "
        "the diagonal of the regions, but at least 1.5 mean edges of their tetrahedra"),
    Key("tolerance", &Region::tolerance, above(0).below(1).optional(),
        "relative L2 error of the displacement of reduced regions, the same for all. Where more is "
        "estimated, `lobe run` computes parts of the region in full for a while. Without it errors above 2 "
        "% are warned of, not corrected"),
    Key("where", &Region::where, any.optional(), "which tetrahedra, of those that are left"));

template <>
inline constexpr auto table_of<SceneGesture> =
    Table("gesture", R"({"oneOf": [{"required": ["displacement"]}, {"required": ["force"]}]})",
          Key("name", &SceneGesture::name, any.items(1).derived(),
              "for reports; without it, its place in the file"),
          Key("where", &SceneGesture::where, any.required(), "the vertices that it moves or loads"),
          Key("displacement", Case(&SceneGesture::is_force, false, &SceneGesture::value),
              any.in("m").optional(), "where they are moved to"),
          Key("force", Case(&SceneGesture::is_force, true, &SceneGesture::value), any.in("N").optional(),
              "total dead load on them"));

template <>
inline constexpr auto table_of<AutoRegions> = Table(
    "auto_regions", "",

    Key("tolerance", &AutoRegions::tolerance, above(0).below(1),
        "relative L2 error of the displacement, in each gesture"),
    Key("precomputed", &AutoRegions::precomputed, any,
        "whether linear regions may be precomputed; `false` where they will be cut often"),
    Key("reduced", &AutoRegions::reduced, any,
        "whether all is one reduced region, in place of linear regions and `time.selective_mass`, if a cell "
        "of its lattice has the volume of more than 60 tetrahedra"),
    Key("correct", &AutoRegions::correct, any,
        "whether `lobe run` corrects linear regions while the scene runs, by the estimated error"),
    Key("gestures", &AutoRegions::gestures, any,
        "what will be done. Without any: the grasps of the scene, each at its furthest place; without "
        "grasps: outward pulls at five places of the free surface by a tenth of the body's diagonal"));

}  // namespace lobe::keys
