// The kinds of tools. Each is a class in a file of its own, and is listed in ToolLists and ToolSetups
// (setup/tool_setups.h); its command is listed in ToolCommand. All of them have
//
//   Path             the struct of setup/tool_setups.h from which one is made, Path::type its name in scenes
//   Bring            the command by which one is made
//   id, name, is_live
//   lead(pose), let_go(), has_gone(), is_on(), and turn_on(on) where there is something to turn on: live ones
//   has_ended(time)  whether a live one was taken away, and its path ended before that time
//   settle()         packs its path, which grows no more
//   shape()          what there is to draw
//   begin_frame(time, end)          the path of a live one grows by what it is to do until then
//   paths()                         what has been done so far, as tools of a setup
//   add_work(from, to, work)        what it does to the body between two times
//   append_bodies(from, to, bodies) the rigid bodies with which it touches the body; only in kinds with some
//   append_needles(from, to, needles) the needles with which it sews; only in kinds with some
//   force, torque                   on the body; only in kinds with some
//   cut_by(work, way, tip)          adds what its blade has cut in a step; only in kinds with a blade, whose
//                                   pose is `pose`
//   placed(time, held)              where it is; none: nowhere
//   fits(vertex_count)              whether it can be one that was kept, with so many vertices now
#pragma once

#include <tuple>
#include <variant>
#include <vector>

#include "lobe/tool/cautery.h"
#include "lobe/tool/clip_applier.h"
#include "lobe/tool/grasp.h"
#include "lobe/tool/needle.h"
#include "lobe/tool/probe.h"
#include "lobe/tool/scalpel.h"

namespace lobe {

struct ToolLists {
  std::vector<Grasp> grasps;
  std::vector<Cautery> cauteries;
  std::vector<Scalpel> scalpels;
  std::vector<Probe> probes;
  std::vector<ClipApplier> clip_appliers;
  std::vector<Needle> needles;
  static constexpr auto fields =
      std::tuple(&ToolLists::grasps, &ToolLists::cauteries, &ToolLists::scalpels, &ToolLists::probes,
                 &ToolLists::clip_appliers, &ToolLists::needles);
};

// Moves a tool at constant speed, so that it is at the target at the end of the next frame.
struct Lead {
  ToolId tool = 0;
  ToolPose target;  // pose of its centre; for a scalpel and a cautery of its tip, for a needle of its circle
  bool operator==(const Lead&) const = default;
  static constexpr auto fields = std::tuple(&Lead::tool, &Lead::target);
};

// Switches a tool on or off. While it is on a cautery burns, a scalpel cuts, and jaws close. A clip applier
// closes a clip when it is switched on.
struct SwitchTool {
  ToolId tool = 0;
  bool on = false;
  bool operator==(const SwitchTool&) const = default;
  static constexpr auto fields = std::tuple(&SwitchTool::tool, &SwitchTool::on);
};

// Ends a tool. A grasp lets go at the start of the next frame. Another tool is taken away.
struct LetGo {
  ToolId tool = 0;
  bool operator==(const LetGo&) const = default;
  static constexpr auto fields = std::tuple(&LetGo::tool);
};

// The commands that add a tool. Each has a name and check(vertex_count, used), says whether its tool needs
// the body's grains, and by turn() how the tool is turned at first, where it says so. The tool's id is
// tools().next_id().
template <class... Kind>
std::variant<typename Kind::Bring...> bring_one_of(
    std::tuple<std::vector<Grasp> ToolLists::*, std::vector<Kind> ToolLists::*...>);  // not defined
using BringTool = decltype(bring_one_of(ToolLists::fields));                          // all but TakeHold

// Recordings number them in this order: further ones come last.
using ToolCommand = std::variant<TakeHold, BringCautery, BringScalpel, BringProbe, Lead, SwitchTool, LetGo,
                                 BringClipApplier, BringNeedle>;

// Whether tools of this kind cut with a blade.
template <class Kind>
concept HasBlade = requires(Kind tool) {
  tool.cut_by(CutWork(), Vec3d(), Vec3d());
};

// Whether a tool of these needs the body's grains.
inline bool need_grains(const ToolSetups& setups) {
  return [&]<class... Kind>(std::tuple<std::vector<Kind> ToolLists::*...>) {
    return ((Kind::Bring::needs_grains && !list_of<typename Kind::Path>(setups).empty()) || ...);
  }(ToolLists::fields);
}

}  // namespace lobe
