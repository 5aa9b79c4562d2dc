// What scenes say of grasps (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/boundary_keys.h"
#include "lobe/scene/selector_keys.h"
#include "lobe/scene/tool_kind.h"

namespace lobe {
namespace keys {

template <>
inline constexpr auto table_of<SceneGrasp> =
    Table("grasp", "",
          Key("where", &SceneGrasp::where, any.required().quiet(),
              "the vertices it takes hold of. It moves the components that `boundary` leaves free"),
          Key("hold_by", &SceneGrasp::hold_by, any.quiet(), hold_by_sentence),
          Key("copies", &SceneGrasp::copies,
              any.optional().as(
                  R"({"type": "array", "minItems": 1, "uniqueItems": true,
                                    "items": {"$ref": "#/definitions/index"}})",
                  "list of integers"),
              "further vertices, which cuts make before it takes hold; `where` may then select none"),
          turning_path_key(
              "offsets [time, x, y, z] from where it took hold, and its turn about its centre there as a "
              "quaternion [.., qx, qy, qz, qw]; without one it does not turn"),
          Key("release", &SceneGrasp::release, any,
              "whether it lets go after the last row; otherwise it holds on there"));

}  // namespace keys

template <>
struct KindOf<SceneGrasp> : TurningRows {
  using ToolSetup = GraspSetup;
  static constexpr const char* row = "4 numbers, or 8 with a quaternion";
  static void resolve(Resolution& resolution, SceneGrasp& tool, const std::string& here);
  static void summarise(const GraspSetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
  static SceneGrasp from_setup(const GraspSetup& setup, Index mesh_vertices);
};

}  // namespace lobe
