// What scenes say of clip appliers (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/tool_kind.h"

namespace lobe {
namespace keys {

template <>
inline constexpr auto table_of<ClipApplierSetup> =
    Table("clip_applier", "",
          Key("name", NotKept<std::string>{}, any.optional(), "name of its clips. Default: the type"),
          Key("length", In{&ClipApplierSetup::clip, &ClipShape::length}, above(0).in("m").required(),
              "length of the legs of a clip, along its x axis"),
          Key("opening", In{&ClipApplierSetup::clip, &ClipShape::opening}, above(0).in("m").required(),
              "distance of the legs before the clip closes, along its z axis"),
          Key("gap", In{&ClipApplierSetup::clip, &ClipShape::gap}, above(0).in("m").required(),
              "distance of the legs when the clip has closed; below `opening`"),
          Key("width", In{&ClipApplierSetup::clip, &ClipShape::width}, above(0).in("m"),
              "width of the legs along the y axis, which is that of the duct"),
          Key("stiffness", In{&ClipApplierSetup::clip, &ClipShape::stiffness}, above(0).in("N/m"),
              "force by which closed legs resist being further apart"),
          turning_path_key(
              "closes a clip at each row: [time, x, y, z] of its middle, or [.., qx, qy, qz, qw] with its "
              "turn"));

}  // namespace keys

template <>
struct KindOf<ClipApplierSetup> : TurningRows {
  using ToolSetup = ClipApplierSetup;
  static constexpr const char* row = "4 numbers, time and place of a clip, or 8 with a quaternion";
  static void resolve(Resolution& resolution, ClipApplierSetup& tool, const std::string& here);
  static BringTool bring(Resolution& resolution, const ClipApplierSetup& tool, const std::string& here);
  static void summarise(const ClipApplierSetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
};

}  // namespace lobe
