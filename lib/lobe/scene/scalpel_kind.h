// What scenes say of scalpels (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/tool_kind.h"

namespace lobe {
namespace keys {

template <>
inline constexpr std::array words_of<CutSurface>{"smooth", "faces"};

template <>
inline constexpr auto table_of<SceneScalpel> = Table(
    "scalpel", "",
    Key("surface", &SceneScalpel::surface, any,
        "`\"smooth\"`: the cut is the surface that the blade sweeps, through tetrahedra. `\"faces\"`: "
        "it follows faces of the mesh"),
    Key("blade", When(&SceneScalpel::blade, never), any.in("m").optional(),
        "vector from tip to heel, where it is the same all along: rows of the path are then [time, x, "
        "y, z] of the tip"),
    Key("snap", &SceneScalpel::snap, at_least(0.02).up_to(0.3),
        "a vertex nearer to the cut than this share of its shortest edge lies on the cut"),
    path_key(R"({"type": "array", "minItems": 1, "items": {
                     "type": "array", "minItems": 4, "maxItems": 7, "items": [
                       {"type": "number", "minimum": 0},
                       {"type": "number"}, {"type": "number"}, {"type": "number"}, {"type": "number"},
                       {"type": "number"}, {"type": "number"}]}})",
             "rows [time, tip x, y, z, heel x, y, z] of both ends of the cutting edge in s and m, or with a "
             "blade [time, tip x, y, z]; times increasing, linear between"));

}  // namespace keys

template <>
struct KindOf<SceneScalpel> {
  using ToolSetup = ScalpelSetup;
  static constexpr const char* row =
      "7 numbers: time, tip and heel, or 4 where there is a \"blade\": time and tip";
  static bool read_row(const nlohmann::json& row, SceneScalpel& tool);
  static void write_row(const SceneScalpel& tool, std::size_t number, nlohmann::ordered_json& row);
  static void resolve(Resolution& resolution, SceneScalpel& tool, const std::string& here);
  static BringTool bring(Resolution& resolution, const SceneScalpel& tool, const std::string& here);
  static void summarise(const ScalpelSetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
  static SceneScalpel from_setup(const ScalpelSetup& setup, Index mesh_vertices);
};

}  // namespace lobe
