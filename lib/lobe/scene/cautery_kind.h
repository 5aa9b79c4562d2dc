// What scenes say of cauteries (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/tool_kind.h"

namespace lobe {
namespace keys {

template <>
inline constexpr auto table_of<CauterySetup> = Table(
    "cautery", "",
    Key("radius", &CauterySetup::radius, above(0).in("m").required(),
        "radius of its spherical tip, and of its hook"),
    Key("hook", &CauterySetup::hook, any.in("m").with(&Takes::is_quiet, true),
        "vector from the tip to the end of a hook: a straight wire that burns all along. Zero: it has none"),
    Key("core", &CauterySetup::core, at_least(0).in("m").quiet(),
        "radius of a rigid wire inside it, which tissue touches as it does a probe: the hook of a hand lifts "
        "and pushes. Below `radius`. 0: it has none"),
    turning_path_key(
        "positions [time, x, y, z] of its tip; with [.., qx, qy, qz, qw] the hook is turned so about the "
        "tip"));

}  // namespace keys

template <>
struct KindOf<CauterySetup> : TurningRows {
  using ToolSetup = CauterySetup;
  static constexpr const char* row = "4 numbers, time and place of the tip, or 8 with a quaternion";
  static void resolve(Resolution& resolution, CauterySetup& tool, const std::string& here);
  static BringTool bring(Resolution& resolution, const CauterySetup& tool, const std::string& here);
  static void summarise(const CauterySetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
};

}  // namespace lobe
