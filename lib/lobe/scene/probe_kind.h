// What scenes say of probes (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/contact_keys.h"
#include "lobe/scene/tool_kind.h"

namespace lobe {

// The file of its shape.
void after_reading(const nlohmann::json& entry, SceneProbe& tool);
void after_writing(const SceneProbe& tool, nlohmann::ordered_json& entry);

namespace keys {

template <>
inline constexpr auto table_of<SceneProbe> = Table(
    "probe", "", Key("shape", &SceneProbe::shape, any.required(), "what touches the organ"),
    Key("friction", &SceneProbe::friction, at_least(0), "coefficient of Coulomb's law against tissue"),
    path_key(
        R"({"type": "array", "minItems": 1, "items": {
                     "type": "array", "minItems": 4, "maxItems": 9, "items": [
                       {"type": "number", "minimum": 0},
                       {"type": "number"}, {"type": "number"}, {"type": "number"}, {"type": "number"},
                       {"type": "number"}, {"type": "number"}, {"type": "number"}, {"type": "number"}]}})",
        "positions [time, x, y, z], and orientations as quaternions [.., qx, qy, qz, qw]; without one its "
        "axes are those of the scene. Of jaws, one more number: how far they are apart [m]. Uniform "
        "motion between"),
    Key("release", &SceneProbe::release, any,
        "whether it is taken away after the last row; otherwise it stays there"));

}  // namespace keys

template <>
struct KindOf<SceneProbe> : TurningRows {
  using ToolSetup = ProbeSetup;
  static constexpr const char* row = "4 numbers, or 8 with a quaternion; one more for the opening of jaws";
  static bool read_row(const nlohmann::json& row, SceneProbe& tool);
  static void write_row(const SceneProbe& tool, std::size_t number, nlohmann::ordered_json& row);
  static void resolve(Resolution& resolution, SceneProbe& tool, const std::string& here);
  static BringTool bring(Resolution& resolution, const SceneProbe& tool, const std::string& here);
  static void summarise(const ProbeSetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
};

}  // namespace lobe
