// What scenes say of needles (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/tool_kind.h"

namespace lobe {
namespace keys {

// A member of its settings, or of its shape among these.
template <class Value>
struct OfNeedle {
  Value NeedleSettings::*member;
  Value& operator()(NeedleSetup& needle) const { return needle.settings.*member; }
  const Value& operator()(const NeedleSetup& needle) const { return needle.settings.*member; }
};
struct OfNeedleShape {
  double NeedleShape::*member;
  double& operator()(NeedleSetup& needle) const { return needle.settings.shape.*member; }
  const double& operator()(const NeedleSetup& needle) const { return needle.settings.shape.*member; }
};

template <>
inline constexpr auto table_of<TieSetup> = Table(
    "needle_tie", "", Key("from", &TieSetup::from, index.required(), "the bite, from 0, that it joins"),
    Key("to", &TieSetup::to, index.required(), "with a later one"),
    Key("at", &TieSetup::at, at_least(0).in("s").required(), "when it is tied"),
    Key("tighten", &TieSetup::tighten, at_least(0).in("m"), "length by which the loop is drawn together"),
    Key("over", &TieSetup::over, at_least(0).in("s"), "time in which it is drawn together"));

template <>
inline constexpr auto table_of<NeedleSetup> = Table(
    "needle", "",
    Key("radius", OfNeedleShape{&NeedleShape::radius}, above(0).in("m").required(),
        "radius of the circle that it is an arc of"),
    Key("angle", OfNeedleShape{&NeedleShape::angle}, above(0).below(6.283185307179586).in("rad"),
        "angle of the arc: π is a half circle, 2.356 a three-eighths one"),
    Key("thickness", OfNeedleShape{&NeedleShape::thickness}, above(0).in("m"),
        "diameter of its wire, below `radius`; to draw it, and for a warning where the mesh is finer"),
    Key("puncture", OfNeedle<double>{&NeedleSettings::puncture}, above(0).in("N").required(),
        "force of the tip along the needle at which the surface gives way, from outside and from inside"),
    Key("friction", OfNeedle<double>{&NeedleSettings::friction}, at_least(0).in("N/m").required(),
        "force along it, per length that is in tissue"),
    Key("thread", &NeedleSetup::thread, index.optional(),
        "number of the thread at its end, which no stitch of `threads` has; without it, it leaves none"),
    Key("thread_length", &NeedleSetup::thread_length, above(0).in("m"),
        "length of that thread: its end slips out of the tissue when it is drawn through"),
    Key("thread_stiffness", In{&NeedleSetup::material, &ThreadMaterial::stiffness}, above(0).in("N"),
        "EA of that thread: tension per strain"),
    Key("thread_friction", In{&NeedleSetup::material, &ThreadMaterial::friction}, at_least(0),
        "μ of the capstan law where that thread passes through tissue"),
    Key("thread_strength", In{&NeedleSetup::material, &ThreadMaterial::strength}, above(0).in("N").optional(),
        "tension above which that thread breaks; without it, it does not"),
    Key("thread_holds", In{&NeedleSetup::material, &ThreadMaterial::holds}, above(0).in("N").optional(),
        "force that tissue bears at a bite of that thread; without it, any"),
    Key("ties", &NeedleSetup::ties, any, "knots of that thread; not of a needle that a hand brings"),
    turning_path_key(
        "centres of its circle [time, x, y, z], and orientations [.., qx, qy, qz, qw]; without one its axes "
        "are those of the scene. The arc is in its plane z = 0; the tip is at [radius, 0, 0] and points "
        "along y"),
    Key("release", &NeedleSetup::release, any,
        "whether it is taken away after the last row; otherwise it stays there"));

}  // namespace keys

template <>
struct KindOf<NeedleSetup> : TurningRows {
  using ToolSetup = NeedleSetup;
  static constexpr const char* row = "4 numbers, time and centre, or 8 with a quaternion";
  static void resolve(Resolution& resolution, NeedleSetup& tool, const std::string& here);
  static BringTool bring(Resolution& resolution, const NeedleSetup& tool, const std::string& here);
  static void summarise(const NeedleSetup& setup, nlohmann::ordered_json& entry);
  static std::string describe(const nlohmann::ordered_json& entry);
};

}  // namespace lobe
